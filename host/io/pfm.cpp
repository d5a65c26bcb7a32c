#include "host/io/pfm.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

using sensing::FloatImage;

constexpr int kLargestSide = 16384;
constexpr std::size_t kSample = 4;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

struct Header {
  int width = 0;
  int height = 0;
  bool little_endian = true;
  std::size_t end = 0;  ///< where the samples begin
};

/// The next word of the header; the one blank behind it is skipped, what follows is not.
std::string_view next_word(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && is_blank(bytes[at])) ++at;
  const std::size_t first = at;
  while (at < bytes.size() && !is_blank(bytes[at])) ++at;
  const std::string_view word = bytes.substr(first, at - first);
  at = std::min(at + 1, bytes.size());
  return word;
}

template <class T>
bool parse(std::string_view word, T& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

Header read_header(const std::string& path, std::string_view bytes) {
  const auto fail = [&path](std::string_view what) {
    throw Error(fmt::format("{}: PFM file is damaged ({})", path, what));
  };
  Header header;
  std::size_t at = 0;
  const std::string_view kind = next_word(bytes, at);
  if (kind == "PF") {
    throw Error(fmt::format("{}: PFM file of three channels, expected one", path));
  }
  if (kind != "Pf") fail("no header");
  const bool sized =
      parse(next_word(bytes, at), header.width) && parse(next_word(bytes, at), header.height);
  if (!sized) fail("header, expected width and height");
  if (header.width < 1 || header.height < 1 || header.width > kLargestSide ||
      header.height > kLargestSide) {
    fail("impossible size");
  }
  double scale = 0;
  if (!parse(next_word(bytes, at), scale) || !std::isfinite(scale) || scale == 0) {
    fail("header, expected a scale whose sign says the byte order");
  }
  header.little_endian = scale < 0;
  header.end = at;
  return header;
}

}  // namespace

bool is_pfm(std::string_view bytes) {
  return bytes.size() >= 3 && bytes[0] == 'P' && (bytes[1] == 'f' || bytes[1] == 'F') &&
         is_blank(bytes[2]);
}

FloatImage read_pfm(const std::string& path) {
  const std::string bytes = read_file(path);
  const Header header = read_header(path, bytes);
  const std::size_t expected =
      kSample * static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  const std::size_t found = bytes.size() - header.end;
  if (found != expected) {
    throw Error(fmt::format("{}: PFM file is {} ({} bytes of samples, expected {})", path,
                            found < expected ? "truncated" : "damaged", found, expected));
  }
  FloatImage image(header.width, header.height);
  std::size_t at = header.end;
  for (int y = header.height - 1; y >= 0; --y) {
    for (int x = 0; x < header.width; ++x, at += kSample) {
      std::uint32_t bits = 0;
      for (std::size_t i = 0; i < kSample; ++i) {
        const std::size_t shift = 8 * (header.little_endian ? i : kSample - 1 - i);
        bits |= std::uint32_t{static_cast<std::uint8_t>(bytes[at + i])} << shift;
      }
      const float value = std::bit_cast<float>(bits);
      image.at(x, y) = std::isfinite(value) && value > 0 ? value : 0.0F;
    }
  }
  return image;
}

void write_pfm(const std::string& path, const FloatImage& image) {
  std::string bytes = fmt::format("Pf\n{} {}\n-1\n", image.width, image.height);
  bytes.reserve(bytes.size() + kSample * image.pixels.size());
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      float value = image.at(x, y);
      if (!std::isfinite(value) || value <= 0) value = std::numeric_limits<float>::infinity();
      const auto bits = std::bit_cast<std::uint32_t>(value);
      for (std::size_t i = 0; i < kSample; ++i) bytes += static_cast<char>(bits >> (8 * i) & 0xff);
    }
  }
  write_file(path, bytes);
}

}  // namespace partita::io
