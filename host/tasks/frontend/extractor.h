// Feature extraction on the device: from an image to keypoints and descriptors, which stay there.
#ifndef PARTITA_HOST_TASKS_FRONTEND_EXTRACTOR_H
#define PARTITA_HOST_TASKS_FRONTEND_EXTRACTOR_H

#include <array>
#include <vector>

#include "host/runtime/kernel.h"
#include "host/tasks/frontend/frontend.h"
#include "host/tasks/frontend/layout.h"

namespace partita::frontend {

/// One image with its features, on the device.
struct DeviceFeatures {
  std::array<cl::Buffer, kLevels> images;
  std::array<cl::Buffer, kLevels> blurred;
  cl::Buffer keypoints;    ///< Keypoint per feature, cell by cell, level 0 first
  cl::Buffer descriptors;  ///< 8 words per feature
  cl::Buffer cell_start;   ///< first feature of every cell, and their number behind the last
  cl::Buffer count;
  int features = 0;  ///< known after read_count()
};

class Extractor {
 public:
  Extractor(const runtime::Session& session, Size size, const FrontendParameters& parameters);

  DeviceFeatures allocate() const;
  /// Enqueues upload, pyramid, corners, selection and blur; `image` has to live until read_count().
  void detect(const GrayImage& image, DeviceFeatures& features);
  /// Waits for the number of features.
  void read_count(DeviceFeatures& features);
  /// Enqueues orientation and descriptors.
  void describe(DeviceFeatures& features);

  Size size() const { return grids_.size; }
  const Grids& grids() const { return grids_; }

 private:
  void detect_level(const cl::Buffer& image, int level);

  const runtime::Session& session_;
  Grids grids_;
  int threshold_high_;
  int threshold_low_;
  runtime::Kernel pyramid_down_;
  runtime::Kernel fast_score_;
  runtime::Kernel gaussian_blur_;
  runtime::Kernel select_cells_;
  runtime::Kernel compact_;
  runtime::Kernel describe_;
  cl::Buffer score_;  ///< of one level, one after the other
  cl::Buffer slots_;  ///< of both levels
  cl::Buffer table_;  ///< test pattern, turned
};

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_EXTRACTOR_H
