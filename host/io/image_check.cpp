#include "host/io/image_check.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace partita::io {

namespace {

constexpr std::uint32_t kLargestSide = 16384;
constexpr const char* kTruncated = "truncated";
constexpr const char* kBadSize = "damaged (impossible size)";

std::uint8_t byte_at(std::string_view b, std::size_t i) {
  return static_cast<std::uint8_t>(b[i]);
}

std::uint32_t big_endian(std::string_view b, std::size_t at, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | byte_at(b, at + static_cast<std::size_t>(i));
  return value;
}

bool possible_size(std::uint32_t width, std::uint32_t height) {
  return width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide;
}

std::uint32_t crc32(std::string_view bytes) {
  static const auto kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xedb88320U ^ c >> 1 : c >> 1;
      table[i] = c;
    }
    return table;
  }();
  std::uint32_t crc = 0xffffffffU;
  for (const char c : bytes) crc = kTable[(crc ^ static_cast<std::uint8_t>(c)) & 0xff] ^ crc >> 8;
  return ~crc;
}

std::string png_defect(std::string_view b) {
  bool data = false;
  for (std::size_t at = 8; at + 12 <= b.size();) {
    const std::size_t length = big_endian(b, at, 4);
    if (length > b.size() - at - 12) return kTruncated;
    const std::string_view type = b.substr(at + 4, 4);
    if (crc32(b.substr(at + 4, length + 4)) != big_endian(b, at + 8 + length, 4)) {
      return "damaged (wrong checksum)";
    }
    if (at == 8) {
      if (type != "IHDR" || length != 13) return "damaged (no header)";
      if (!possible_size(big_endian(b, 16, 4), big_endian(b, 20, 4))) return kBadSize;
    }
    data = data || (type == "IDAT" && length > 0);
    if (type == "IEND") return data ? "" : "damaged (no picture data)";
    at += length + 12;
  }
  return kTruncated;
}

/// Skips the entropy-coded bytes after a scan's header: up to the next marker that is neither a
/// stuffed zero nor a restart.
std::size_t end_of_scan(std::string_view b, std::size_t at) {
  for (; at + 1 < b.size(); ++at) {
    const std::uint8_t next = byte_at(b, at + 1);
    if (byte_at(b, at) == 0xff && next != 0 && next != 0xff && (next < 0xd0 || next > 0xd7))
      return at;
  }
  return b.size();
}

std::string jpeg_defect(std::string_view b) {
  bool frame = false;
  bool scan = false;
  for (std::size_t at = 2; at + 2 <= b.size();) {
    if (byte_at(b, at) != 0xff) return "damaged (no marker where one was expected)";
    const std::uint8_t marker = byte_at(b, at + 1);
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0xd9) return frame && scan ? "" : "damaged (no picture data)";
    if (at + 4 > b.size()) return kTruncated;
    const std::size_t length = big_endian(b, at + 2, 2);
    if (length < 2) return "damaged (empty segment)";
    if (length > b.size() - at - 2) return kTruncated;
    const bool start_of_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (start_of_frame) {
      if (length < 8) return "damaged (short header)";
      if (!possible_size(big_endian(b, at + 7, 2), big_endian(b, at + 5, 2))) return kBadSize;
      frame = true;
    }
    at += 2 + length;
    if (marker == 0xda) {
      scan = true;
      at = end_of_scan(b, at);
    }
  }
  return kTruncated;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

std::string pnm_defect(std::string_view b) {
  std::array<std::uint32_t, 3> header{};  // width, height, largest value
  std::size_t at = 2;
  for (std::uint32_t& value : header) {
    if (at < b.size() && !is_blank(b[at])) return "damaged (header)";
    while (at < b.size() && (is_blank(b[at]) || b[at] == '#')) {
      at = b[at] == '#' ? std::min(b.find_first_of("\r\n", at), b.size()) : at + 1;
    }
    const std::size_t first = at;
    for (; at < b.size() && b[at] >= '0' && b[at] <= '9'; ++at) {
      value = value * 10 + static_cast<std::uint32_t>(b[at] - '0');
      if (value > 65535) return kBadSize;
    }
    if (at == b.size()) return kTruncated;
    if (at == first || !is_blank(b[at])) return "damaged (header)";
  }
  if (!possible_size(header[0], header[1])) return kBadSize;
  if (header[2] == 0) return "damaged (header)";
  const std::size_t sample = (b[1] == '6' ? 3U : 1U) * (header[2] > 255 ? 2U : 1U);
  const std::size_t needed = std::size_t{header[0]} * header[1] * sample;
  return b.size() - at - 1 < needed ? kTruncated : "";
}

}  // namespace

std::string image_defect(std::string_view bytes) {
  if (bytes.empty()) return "empty";
  const std::string_view png("\x89PNG\r\n\x1a\n", 8);
  if (bytes.substr(0, 8) == png) return png_defect(bytes);
  if (bytes.substr(0, 3) == "\xff\xd8\xff") return jpeg_defect(bytes);
  if (bytes.size() >= 2 && bytes[0] == 'P' && (bytes[1] == '5' || bytes[1] == '6')) {
    return pnm_defect(bytes);
  }
  const bool begun = png.substr(0, bytes.size()) == bytes;
  return begun ? kTruncated : "not a PNG, JPEG or PGM picture";
}

}  // namespace partita::io
