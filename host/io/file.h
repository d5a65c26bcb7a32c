// Files that are whole or not there at all.
#ifndef PARTITA_HOST_IO_FILE_H
#define PARTITA_HOST_IO_FILE_H

#include <cstdio>
#include <string>
#include <string_view>

namespace partita::io {

/// Writes a file under a temporary name beside it; commit() gives it its name. A reader therefore
/// sees the old file or the whole new one, also when the process is killed half-way. (Against a
/// power cut it does not guard: that would cost an fsync for every disparity map.)
/// Every failure, a full disk included, is an Error that names the final path.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();  ///< without commit(): removes the temporary file
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void commit();  ///< to be called once, last
  const std::string& path() const { return path_; }

  /// The name under which `path` is written before it is whole: ".NAME.partial" in its folder.
  static std::string temporary_path(const std::string& path);

 private:
  [[noreturn]] void fail(int error_number);

  std::string path_;
  std::FILE* file_ = nullptr;
};

/// The whole content at once, through an AtomicFile.
void write_file(const std::string& path, std::string_view bytes);

/// The whole content of a regular file; throws Error that names the path.
std::string read_file(const std::string& path);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_FILE_H
