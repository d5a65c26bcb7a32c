// Ground truth of disparities, in the formats that stereo benchmarks come in.
#ifndef PARTITA_HOST_IO_TRUTH_H
#define PARTITA_HOST_IO_TRUTH_H

#include <optional>
#include <string>

#include "host/tasks/sensing/frame.h"

namespace partita::io {

struct Truth {
  sensing::FloatImage disparity;  ///< pixels; 0 where it is unknown
  std::string format;             ///< how the file was understood: "16 bit, 256 levels a pixel"
};

/// Reads a PFM file (pixels; not finite: unknown) or a picture of levels, 0 meaning unknown:
/// 16 bits with `scale` levels a pixel, 256 by default (KITTI), or 8 bits with `scale` levels a
/// pixel, by default the first number of "info.txt" beside it (Middlebury, second version). Throws
/// Error for a file that is none of these, for 8 bits without a scale, and for truth without any
/// known pixel.
Truth read_truth(const std::string& path, std::optional<double> scale = {});

/// A mask of pixels that count: 255 where they do, 0 elsewhere, as benchmarks mark what is seen by
/// both cameras. Of a picture's levels only the full one (white) counts.
sensing::GrayImage read_mask(const std::string& path);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_TRUTH_H
