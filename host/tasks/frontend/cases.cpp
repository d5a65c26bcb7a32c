#include "host/tasks/frontend/cases.h"

#include <algorithm>

namespace partita::frontend {

using runtime::ElementType;
using runtime::HostArray;

GrayImage textured_image(Size size, std::uint32_t seed) {
  GrayImage image(size.width, size.height);
  Random random(seed);
  const std::uint32_t salt = random.next();
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto bx = static_cast<std::uint32_t>(x / 7);
      const auto by = static_cast<std::uint32_t>(y / 6);
      std::uint32_t block = (bx * 73856093u) ^ (by * 19349663u) ^ salt;
      block = (block ^ (block >> 15)) * 0x2C1B3C6Du;
      const std::uint32_t grey = (block >> 24) % 236;
      const std::uint32_t noise = bx % 5 == 0 ? 0 : random.next() % 20;
      image.at(x, y) = static_cast<std::uint8_t>(grey + noise);
    }
  }
  return image;
}

GrayImage moved_image(const GrayImage& image, int dx, int dy) {
  GrayImage out(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.row(std::clamp(y - dy, 0, image.height - 1));
    for (int x = 0; x < image.width; ++x) {
      out.at(x, y) = from[std::clamp(x - dx, 0, image.width - 1)];
    }
  }
  return out;
}

golden::FeatureList random_features(Size image, const Grid& grid0, const Grid& grid1,
                                    Random& random) {
  std::vector<std::uint32_t> slots;
  for (int level = 0; level < kLevels; ++level) {
    const Grid& grid = level == 0 ? grid0 : grid1;
    const Size size = level_size(image, level);
    for (int i = 0; i < grid.cells(); ++i) {
      const int left = kBorder + i % grid.columns * grid.cell;
      const int top = kBorder + i / grid.columns * grid.cell;
      const int used = random.between(0, kPerCell);
      for (int k = 0; k < kPerCell; ++k) {
        const int x = random.between(left, std::min(left + grid.cell, size.width - kBorder) - 1);
        const int y = random.between(top, std::min(top + grid.cell, size.height - kBorder) - 1);
        slots.push_back(k < used ? golden::corner_key(random.between(1, 255), x, y) : 0);
      }
    }
  }
  return golden::compact(slots, grid0.cells());
}

std::vector<golden::Descriptor> random_descriptors(std::size_t count, Random& random) {
  std::vector<golden::Descriptor> descriptors(count);
  for (golden::Descriptor& descriptor : descriptors) {
    for (std::uint32_t& word : descriptor) word = random.next();
  }
  return descriptors;
}

HostArray bytes_of(const GrayImage& image) {
  return HostArray::of<std::uint8_t>(ElementType::u8, image.pixels);
}

HostArray scalar(int value) {
  return HostArray::scalar<std::int32_t>(ElementType::i32, value);
}

GrayImage image_of(const HostArray& array, Size size) {
  GrayImage image(size.width, size.height);
  const auto pixels = array.as<std::uint8_t>();
  std::copy_n(pixels.begin(), image.pixels.size(), image.pixels.begin());
  return image;
}

Size size_of(const runtime::Shape& shape) {
  return {static_cast<int>(shape["width"]), static_cast<int>(shape["height"])};
}

}  // namespace partita::frontend
