#include "host/tasks/frontend/extractor.h"

#include <span>

#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/pattern.h"

namespace partita::frontend {
namespace {

runtime::Shape shape_of(Size size) {
  return {{"width", size.width}, {"height", size.height}};
}

/// Level 1 has (5/6)^2 of level 0's area, and the same share of the features: 36/61 and 25/61.
int quota(int max_features, int level) {
  const int first = max_features * 36 / 61;
  return level == 0 ? first : max_features - first;
}

}  // namespace

Extractor::Extractor(const runtime::Session& session, Size size,
                     const FrontendParameters& parameters)
    : session_(session),
      size_(size),
      grids_{finest_grid(level_size(size, 0), quota(parameters.max_features, 0)),
             finest_grid(level_size(size, 1), quota(parameters.max_features, 1))},
      threshold_high_(parameters.fast_threshold),
      threshold_low_(parameters.fast_threshold_low),
      pyramid_down_(session, pyramid_down_spec()),
      fast_score_(session, fast_score_spec()),
      gaussian_blur_(session, gaussian_blur_spec()),
      select_cells_(session, select_cells_spec()),
      compact_(session, compact_spec()),
      describe_(session, describe_spec()),
      score_(session.make_buffer(static_cast<std::size_t>(size.pixels()))),
      slots_(session.make_buffer(static_cast<std::size_t>(capacity()) * 4)),
      table_(session.make_buffer(test_table().size() * 2, CL_MEM_READ_ONLY)) {
  session.write(table_, std::as_bytes(std::span(test_table())));
  session.finish();
}

DeviceFeatures Extractor::allocate() const {
  DeviceFeatures features;
  for (int level = 0; level < kLevels; ++level) {
    const auto bytes = static_cast<std::size_t>(level_size(size_, level).pixels());
    const auto i = static_cast<std::size_t>(level);
    features.images[i] = session_.make_buffer(bytes);
    features.blurred[i] = session_.make_buffer(bytes);
  }
  const auto capacity_of_grid = static_cast<std::size_t>(capacity());
  features.keypoints = session_.make_buffer(capacity_of_grid * sizeof(Keypoint));
  features.descriptors = session_.make_buffer(capacity_of_grid * 32);
  features.cell_start = session_.make_buffer((static_cast<std::size_t>(cells()) + 1) * 4);
  features.count = session_.make_buffer(4);
  return features;
}

void Extractor::detect_level(const cl::Buffer& image, int level) {
  const Size size = level_size(size_, level);
  const Grid& grid = this->grid(level);
  fast_score_.launch(shape_of(size), image, score_, size.width, size.height, threshold_low_);
  select_cells_.launch(shape_of(size).with("cell", grid.cell), score_, slots_, size.width,
                       size.height, grid.cell, level == 0 ? 0 : grids_[0].cells(), threshold_high_);
}

void Extractor::detect(const GrayImage& image, DeviceFeatures& features) {
  session_.write(features.images[0], std::as_bytes(std::span(image.pixels)));
  pyramid_down_.launch(shape_of(size_), features.images[0], features.images[1], size_.width,
                       size_.height);
  detect_level(features.images[0], 0);
  detect_level(features.images[1], 1);
  compact_.launch({{"cells", cells()}, {"keypoints", capacity() / 2}}, slots_, features.keypoints,
                  features.cell_start, features.count, cells(), grids_[0].cells());
  for (int level = 0; level < kLevels; ++level) {
    const Size size = level_size(size_, level);
    const auto i = static_cast<std::size_t>(level);
    gaussian_blur_.launch(shape_of(size), features.images[i], features.blurred[i], size.width,
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
  describe_.launch(shape_of(size_).with("keypoints", features.features), features.images[0],
                   features.images[1], features.blurred[0], features.blurred[1], features.keypoints,
                   features.descriptors, table_, size_.width, features.features);
}

}  // namespace partita::frontend
