#include "host/io/output_folder.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMark = "PARTIAL";

void create_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw Error(fmt::format("cannot create the output folder '{}': {}", path, error.message()));
  }
  if (!fs::is_directory(path)) {
    throw Error(fmt::format("output folder '{}' is not a folder", path));
  }
}

}  // namespace

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {
  create_folder(path_);
  write_file(file(kMark),
             "This run did not finish: the files beside this one may be incomplete.\n");
}

std::string OutputFolder::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

std::string OutputFolder::series(const std::string& name, const std::string& extension) const {
  const std::string folder = file(name);
  create_folder(folder);
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().extension() != extension) continue;
    std::error_code error;
    fs::remove(entry.path(), error);
    if (error) {
      throw Error(fmt::format("cannot remove '{}': {}", entry.path().string(), error.message()));
    }
  }
  return folder;
}

void OutputFolder::complete() {
  std::error_code error;
  fs::remove(file(kMark), error);
  if (error) throw Error(fmt::format("cannot remove '{}': {}", file(kMark), error.message()));
}

bool is_partial(const std::string& path) {
  std::error_code ignored;
  return fs::exists(fs::path(path) / kMark, ignored);
}

}  // namespace partita::io
