// The errors of the host program.
#ifndef PARTITA_HOST_RUNTIME_ERROR_H
#define PARTITA_HOST_RUNTIME_ERROR_H

#include <stdexcept>
#include <string>

namespace partita {

/// What a person reads when something is wrong: one line without a full stop or a line break, made
/// of where (file and line, key, device), what, and what was expected instead. For example
///   "data/calib.txt:2: 11 numbers, expected the 12 of a 3x4 projection matrix"
///   "placement: no task 'localisation', expected one of localization, scene"
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// An Error of OpenCL or a device rather than of the user's input: no platform, a build that fails,
/// a refused buffer or launch. The command line gives it an exit status of its own.
class DeviceError : public Error {
 public:
  using Error::Error;
};

}  // namespace partita

#endif  // PARTITA_HOST_RUNTIME_ERROR_H
