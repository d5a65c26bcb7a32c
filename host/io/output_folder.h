// The folder that a run writes into.
#ifndef PARTITA_HOST_IO_OUTPUT_FOLDER_H
#define PARTITA_HOST_IO_OUTPUT_FOLDER_H

#include <string>

namespace partita::io {

/// Creates the folder (parents included) where it is missing and marks it as partial: a file
/// PARTIAL, which names the writer, lies in it until complete() is called. What an interrupted run
/// leaves behind therefore says so, and who left it. Throws Error that names the folder when it
/// cannot be created or written to.
class OutputFolder {
 public:
  OutputFolder(std::string path, const std::string& writer);

  /// The full path of a file in the folder.
  std::string file(const std::string& name) const;

  /// A sub-folder for a series of numbered files, created or emptied of the files that are named
  /// as the series' are (digits and this extension, ".png"), which an earlier, perhaps longer, run
  /// left there. All else in it stays. Returns its full path.
  std::string series(const std::string& name, const std::string& extension) const;

  /// Everything is written: takes the mark away.
  void complete();

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// The writers of output folders.
inline constexpr const char* kRunWriter = "partita run";
inline constexpr const char* kExploreWriter = "partita explore";
inline constexpr const char* kGenerateWriter = "partita generate";
inline constexpr const char* kTrackWriter = "partita track";
inline constexpr const char* kLocalizeWriter = "partita localize";

/// Whether `path` holds the mark of something unfinished, whoever's it is.
bool is_partial(const std::string& path);
/// Whether `path` holds the mark that this writer leaves.
bool is_partial(const std::string& path, const std::string& writer);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_OUTPUT_FOLDER_H
