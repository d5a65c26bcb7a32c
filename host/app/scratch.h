// A folder for what is needed for a moment, removed at the end.
#ifndef PARTITA_HOST_APP_SCRATCH_H
#define PARTITA_HOST_APP_SCRATCH_H

#include <filesystem>
#include <stdlib.h>
#include <string>

#include "host/app/exit_code.h"

namespace partita::app {

class Scratch {
 public:
  Scratch() : path_((std::filesystem::temp_directory_path() / "partita-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) throw OutputError(path_ + ": cannot be created");
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_SCRATCH_H
