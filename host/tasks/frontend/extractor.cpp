#include "host/tasks/frontend/extractor.h"

#include <span>

#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/pattern.h"
#include "host/tasks/frontend/shapes.h"

namespace partita::frontend {
Extractor::Extractor(const runtime::Session& session, Size size,
                     const FrontendParameters& parameters)
    : session_(session),
      grids_(make_grids(size, parameters.max_features)),
      threshold_high_(parameters.fast_threshold),
      threshold_low_(parameters.fast_threshold_low),
      pyramid_down_(session, pyramid_down_spec()),
      fast_score_(session, fast_score_spec()),
      gaussian_blur_(session, gaussian_blur_spec()),
      select_cells_(session, select_cells_spec()),
      compact_(session, compact_spec()),
      describe_(session, describe_spec()),
      score_(session.make_buffer(static_cast<std::size_t>(size.pixels()))),
      slots_(session.make_buffer(static_cast<std::size_t>(grids_.capacity()) * 4)),
      table_(session.make_buffer(test_table().size() * 2, CL_MEM_READ_ONLY)) {
  session.write(table_, std::as_bytes(std::span(test_table())));
  session.finish();
}

DeviceFeatures Extractor::allocate() const {
  DeviceFeatures features;
  for (int level = 0; level < kLevels; ++level) {
    const auto bytes = static_cast<std::size_t>(level_size(size(), level).pixels());
    const auto i = static_cast<std::size_t>(level);
    features.images[i] = session_.make_buffer(bytes);
    features.blurred[i] = session_.make_buffer(bytes);
  }
  const auto capacity_of_grid = static_cast<std::size_t>(grids_.capacity());
  features.keypoints = session_.make_buffer(capacity_of_grid * sizeof(Keypoint));
  features.descriptors = session_.make_buffer(capacity_of_grid * 32);
  features.cell_start = session_.make_buffer((static_cast<std::size_t>(grids_.cells()) + 1) * 4);
  features.count = session_.make_buffer(4);
  return features;
}

void Extractor::detect_level(const cl::Buffer& image, int level) {
  const Size size = level_size(grids_.size, level);
  const Grid& grid = grids_.at(level);
  fast_score_.launch(image_shape(size), image, score_, size.width, size.height, threshold_low_);
  select_cells_.launch(select_shape(size, grid), score_, slots_, size.width, size.height, grid.cell,
                       level == 0 ? 0 : grids_.at(0).cells(), threshold_high_);
}

void Extractor::detect(const GrayImage& image, DeviceFeatures& features) {
  session_.write(features.images[0], std::as_bytes(std::span(image.pixels)));
  const Size whole = size();
  pyramid_down_.launch(image_shape(whole), features.images[0], features.images[1], whole.width,
                       whole.height);
  detect_level(features.images[0], 0);
  detect_level(features.images[1], 1);
  compact_.launch(compact_shape(grids_), slots_, features.keypoints, features.cell_start,
                  features.count, grids_.cells(), grids_.at(0).cells());
  for (int level = 0; level < kLevels; ++level) {
    const Size size = level_size(whole, level);
    const auto i = static_cast<std::size_t>(level);
    gaussian_blur_.launch(image_shape(size), features.images[i], features.blurred[i], size.width,
                          size.height);
  }
}

void Extractor::read_count(DeviceFeatures& features) {
  cl_int count = 0;
  session_.read(features.count, std::as_writable_bytes(std::span(&count, 1)));
  features.features = count;
}

void Extractor::describe(DeviceFeatures& features) {
  if (features.features == 0) return;
  describe_.launch(describe_shape(grids_, features.features), features.images[0],
                   features.images[1], features.blurred[0], features.blurred[1], features.keypoints,
                   features.descriptors, table_, size().width, features.features);
}

}  // namespace partita::frontend
