// Exit statuses of `partita`. Scripts rely on them: they do not change.
#ifndef PARTITA_HOST_APP_EXIT_CODE_H
#define PARTITA_HOST_APP_EXIT_CODE_H

#include <exception>
#include <stdexcept>

#include "host/runtime/error.h"

namespace partita::app {

enum ExitCode : int {
  exit_ok = 0,
  exit_failure_found =
      1,               ///< the command did its job and the answer is no: verify found a mismatch
  exit_usage = 2,      ///< the command line itself
  exit_bad_input = 3,  ///< data set, profile, device, container: what the user handed in
  exit_device = 4,     ///< OpenCL or a device
  exit_output = 5,     ///< a result could not be written
  exit_internal = 70,  ///< a bug in Partita
  exit_interrupted = 130,  ///< Ctrl-C; what was finished has been written and is marked as partial
};

/// For the end of `partita --help`.
inline constexpr const char* kExitCodeHelp =
    "Exit status: 0 all well, 1 a check found a failure, 2 wrong usage, 3 bad input, 4 OpenCL or "
    "a\n"
    "device, 5 output could not be written, 70 a bug in partita, 130 interrupted.";

/// The command line is understood but cannot be meant: two options that exclude each other.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// A result could not be written: a full disk, a folder without permission.
class OutputError : public Error {
 public:
  using Error::Error;
};

/// Ctrl-C; nothing more to say than that.
class Interrupted : public std::exception {};

/// Runs a function that writes results: what goes wrong there is the output's fault, whatever it
/// was.
template <typename Function>
auto output(Function&& function) {
  try {
    return function();
  } catch (const OutputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw OutputError(error.what());
  }
}

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_EXIT_CODE_H
