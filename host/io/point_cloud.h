// Clouds of points on disk, for a viewer (MeshLab, CloudCompare, Open3D read them).
#ifndef PARTITA_HOST_IO_POINT_CLOUD_H
#define PARTITA_HOST_IO_POINT_CLOUD_H

#include <cstdint>
#include <span>
#include <string>

namespace partita::io {

struct CloudPoint {
  float x = 0, y = 0, z = 0;
  std::uint8_t gray = 0;
};

/// A PLY file, binary and little-endian: x, y, z, and the gray level as red, green and blue.
/// `comment` is one line for whoever opens it with a text editor.
void write_ply(const std::string& path, std::span<const CloudPoint> points,
               const std::string& comment);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_POINT_CLOUD_H
