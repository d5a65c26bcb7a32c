// A stereo pair of two files, as `partita depth` and `partita bench peers` take it.
#ifndef PARTITA_HOST_APP_STEREO_PAIR_H
#define PARTITA_HOST_APP_STEREO_PAIR_H

#include <string>
#include <vector>

#include "host/tasks/depth/depth.h"
#include "host/tasks/sensing/frame.h"

namespace partita::app {

struct StereoPair {
  std::string left_path, right_path;
  sensing::GrayImage left, right;
  std::vector<std::string> conversions;  ///< "left.png: colour, converted to 8-bit gray"
};

/// Throws Error that names the file for what cannot be read, and both if their sizes differ.
StereoPair read_pair(const std::string& left, const std::string& right);

/// What is odd about a map and the pictures that it came from, one line each: pictures of one
/// level, the same picture twice, too few support points, few, or few disparities; and, where there
/// are few, whether the pictures look swapped, for which `depth` matches them the other way round.
std::vector<std::string> doubts(const StereoPair& pair, const depth::DisparityMap& map,
                                const depth::DepthParameters& parameters, depth::Depth& depth);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_STEREO_PAIR_H
