// This program as a child process: some things (the layer, a start-up) can only be measured from a
// process's beginning.
#ifndef PARTITA_HOST_APP_CHILD_H
#define PARTITA_HOST_APP_CHILD_H

#include <map>
#include <string>
#include <vector>

#include "host/runtime/error.h"

namespace partita::app {

/// The child has told the user why, on stderr.
class ChildFailed : public Error {
 public:
  ChildFailed(const std::string& what, int status) : Error(what), status_(status) {}
  int status() const { return status_; }

 private:
  int status_;
};

/// Runs `partita` with the arguments and additional environment variables; returns what it wrote to
/// stdout. Its stderr is ours. Throws Error if it cannot be started or is killed, ChildFailed if it
/// ends with another status than 0.
std::string run_self(const std::vector<std::string>& arguments,
                     const std::map<std::string, std::string>& environment = {});

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_CHILD_H
