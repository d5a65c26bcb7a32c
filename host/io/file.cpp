#include "host/io/file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::io {

namespace fs = std::filesystem;

std::string AtomicFile::temporary_path(const std::string& path) {
  const fs::path p(path);
  return (p.parent_path() / fmt::format(".{}.partial", p.filename().string())).string();
}

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  if (fs::is_directory(path_)) fail(EISDIR);
  file_ = std::fopen(temporary_path(path_).c_str(), "wb");
  if (file_ == nullptr) fail(errno);
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code ignored;
  fs::remove(temporary_path(path_), ignored);
}

void AtomicFile::fail(int error_number) {
  throw Error(fmt::format("cannot write '{}': {}", path_, std::strerror(error_number)));
}

void AtomicFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail(errno);
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0) fail(errno);
  const int closed = std::fclose(std::exchange(file_, nullptr));
  const int close_error = errno;
  std::error_code error;
  if (closed == 0) {
    fs::rename(temporary_path(path_), path_, error);
    if (!error) return;
  }
  std::error_code ignored;
  fs::remove(temporary_path(path_), ignored);
  fail(closed != 0 ? close_error : error.value());
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

std::string read_file(const std::string& path) {
  const auto fail = [&path](int error_number) {
    throw Error(fmt::format("cannot read '{}': {}", path, std::strerror(error_number)));
  };
  std::error_code error;
  if (fs::is_directory(path, error)) fail(EISDIR);
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) fail(errno);
  std::string bytes;
  char block[1 << 16];
  std::size_t got = 0;
  while ((got = std::fread(block, 1, sizeof(block), file)) > 0) bytes.append(block, got);
  const bool failed = std::ferror(file) != 0;
  const int read_error = errno;
  std::fclose(file);
  if (failed) fail(read_error);
  return bytes;
}

}  // namespace partita::io
