#include "host/app/child.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

namespace partita::app {
namespace {

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

std::string run_self(const std::vector<std::string>& arguments,
                     const std::map<std::string, std::string>& environment) {
  std::vector<char*> argv{const_cast<char*>("partita")};
  for (const std::string& word : arguments) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw Error("no pipe to be had for a child process");
  const pid_t child = fork();
  if (child < 0) throw Error("no child process to be had");
  if (child == 0) {
    for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    execv("/proc/self/exe", argv.data());
    _exit(127);
  }
  close(ends[1]);
  const std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const std::string what = fmt::format("partita {} failed in a child process", arguments.front());
  if (!WIFEXITED(status)) throw Error(what);
  if (WEXITSTATUS(status) != 0) throw ChildFailed(what, WEXITSTATUS(status));
  return text;
}

}  // namespace partita::app
