// The folder of a command's results: an earlier one's may be overwritten, other people's files not.
#ifndef PARTITA_HOST_APP_RESULT_FOLDER_H
#define PARTITA_HOST_APP_RESULT_FOLDER_H

#include <string>
#include <vector>

#include "host/io/output_folder.h"

namespace partita::app {

/// What a command leaves in its folder.
struct ResultFiles {
  const char* writer;              ///< as io::OutputFolder marks what is unfinished
  std::string identity;            ///< JSON of ours, which says that the folder is the command's
  std::vector<std::string> files;  ///< all that it may write, the identity included
  std::vector<std::string> folders = {};
};

/// Throws OutputError for a folder in which somebody else's files lie. With `force` it may be
/// written into, but none of its files replaced: what bears a result's name must not be there.
void refuse_foreign_folder(const std::string& folder, bool force, const ResultFiles& results);

/// Throws OutputError where a folder could not be made or nothing written into it: before long work,
/// not after it.
void refuse_unwritable_folder(const std::string& folder);

/// An earlier one's results must not be taken for this one's if this one ends early.
void remove_earlier_results(const io::OutputFolder& folder, const ResultFiles& results);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_RESULT_FOLDER_H
