// Portable float maps: disparities as Middlebury's benchmark writes them.
#ifndef PARTITA_HOST_IO_PFM_H
#define PARTITA_HOST_IO_PFM_H

#include <string>
#include <string_view>

#include "host/tasks/sensing/frame.h"

namespace partita::io {

/// Whether the bytes begin as a PFM file does.
bool is_pfm(std::string_view bytes);

/// Reads a PFM file of one channel, in either byte order (a negative scale: little-endian), bottom
/// row first. Of the scale only the sign counts: files in the wild hold odd magnitudes beside
/// values that are pixels already. What is not positive or not finite is 0: none. Throws Error that
/// names the file unless it is whole: sizes of at most 16384 x 16384, and exactly their samples.
sensing::FloatImage read_pfm(const std::string& path);

/// Writes one, little-endian with scale -1. What is not positive or not finite is written as
/// infinity, which is Middlebury's "unknown".
void write_pfm(const std::string& path, const sensing::FloatImage& image);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_PFM_H
