#include "host/io/point_cloud.h"

#include <bit>

#include <fmt/format.h>

#include "host/io/file.h"

namespace partita::io {

void write_ply(const std::string& path, std::span<const CloudPoint> points,
               const std::string& comment) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      comment, points.size());
  constexpr std::size_t kPointBytes = 3 * sizeof(float) + 3;
  bytes.reserve(bytes.size() + kPointBytes * points.size());
  for (const CloudPoint& point : points) {
    for (const float value : {point.x, point.y, point.z}) {
      const auto bits = std::bit_cast<std::uint32_t>(value);
      for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> (8 * i) & 0xff);
    }
    bytes.append(3, static_cast<char>(point.gray));
  }
  write_file(path, bytes);
}

}  // namespace partita::io
