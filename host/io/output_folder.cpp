#include "host/io/output_folder.h"

#include <filesystem>
#include <fstream>
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

std::string mark_of(const std::string& writer) {
  return writer + " did not finish: the files beside this one may be incomplete.";
}

/// As the files of a series are named: 000042.png.
bool is_numbered(const fs::path& path, const std::string& extension) {
  constexpr std::size_t kLeastDigits = 6;
  const std::string stem = path.stem().string();
  return path.extension() == extension && stem.size() >= kLeastDigits &&
         stem.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

OutputFolder::OutputFolder(std::string path, const std::string& writer) : path_(std::move(path)) {
  create_folder(path_);
  write_file(file(kMark), mark_of(writer) + "\n");
}

std::string OutputFolder::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

std::string OutputFolder::series(const std::string& name, const std::string& extension) const {
  const std::string folder = file(name);
  create_folder(folder);
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file() || !is_numbered(entry.path(), extension)) continue;
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

bool is_partial(const std::string& path, const std::string& writer) {
  std::ifstream mark(fs::path(path) / kMark);
  std::string line;
  return std::getline(mark, line) && line == mark_of(writer);
}

}  // namespace partita::io
