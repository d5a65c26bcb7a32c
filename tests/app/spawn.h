// Runs the command line as a user does: as a process of its own.
#ifndef PARTITA_TESTS_APP_SPAWN_H
#define PARTITA_TESTS_APP_SPAWN_H

#include <functional>
#include <map>
#include <string>
#include <sys/types.h>
#include <vector>

#include <nlohmann/json.hpp>

namespace partita::testing {

struct Outcome {
  int status = -1;  ///< exit status; 128 + signal if one ended it
  std::string out, err;
};

using Environment = std::map<std::string, std::string>;

/// Runs `partita` with the arguments; the environment's variables are added to this process's own.
/// `meanwhile` is called with the process id while it runs.
Outcome partita(const std::vector<std::string>& arguments, const Environment& environment = {},
                const std::function<void(pid_t)>& meanwhile = {});

/// The same, must end with status 0; its stdout as JSON (--json is added).
nlohmann::json partita_json(std::vector<std::string> arguments,
                            const Environment& environment = {});

/// A failure that a person can understand: the status, nothing on stdout, one line on stderr that
/// starts with "partita: " and holds every one of `parts`.
void expect_one_line(const Outcome& outcome, int status, const std::vector<std::string>& parts);

/// The bytes of a file; a test failure if there is none.
std::string bytes_of(const std::string& path);

}  // namespace partita::testing

#endif  // PARTITA_TESTS_APP_SPAWN_H
