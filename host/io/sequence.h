// Folders of numbered pictures.
#ifndef PARTITA_HOST_IO_SEQUENCE_H
#define PARTITA_HOST_IO_SEQUENCE_H

#include <string>
#include <vector>

namespace partita::io {

/// The paths of the PNG, JPEG, PGM and PPM files in FOLDER/img, if there is such a folder (as in
/// the OTB benchmark), else in FOLDER itself: in the order of their numbers if all are named by
/// numbers, else of their names. Hidden files are left out. Throws Error if there is no such
/// folder, or no picture in it.
std::vector<std::string> list_pictures(const std::string& folder);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_SEQUENCE_H
