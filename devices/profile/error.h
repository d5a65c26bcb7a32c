// The error that profiles, models and timelines throw. The devices know nothing of the host
// program, so it is not the host's Error; both are std::runtime_error with one line for a person.
#ifndef PARTITA_DEVICES_PROFILE_ERROR_H
#define PARTITA_DEVICES_PROFILE_ERROR_H

#include <stdexcept>
#include <string>

namespace partita::profile {

/// One line: where (file:line, key), what is wrong, what was expected and in which range.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace partita::profile

#endif  // PARTITA_DEVICES_PROFILE_ERROR_H
