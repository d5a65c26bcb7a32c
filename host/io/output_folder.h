// The folder that a run writes into.
#ifndef PARTITA_HOST_IO_OUTPUT_FOLDER_H
#define PARTITA_HOST_IO_OUTPUT_FOLDER_H

#include <string>

namespace partita::io {

/// Creates the folder (parents included) where it is missing and marks it as partial: a file
/// PARTIAL lies in it until complete() is called. What an interrupted run leaves behind therefore
/// says so. Throws Error that names the folder when it cannot be created or written to.
class OutputFolder {
 public:
  explicit OutputFolder(std::string path);

  /// The full path of a file in the folder.
  std::string file(const std::string& name) const;

  /// A sub-folder for a series of files, created or emptied of the files with this extension
  /// (".png") that an earlier, perhaps longer, run left there. Returns its full path.
  std::string series(const std::string& name, const std::string& extension) const;

  /// Everything is written: takes the mark away.
  void complete();

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Whether `path` holds the mark of an unfinished run.
bool is_partial(const std::string& path);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_OUTPUT_FOLDER_H
