#include "host/io/truth.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/image.h"
#include "host/io/pfm.h"
#include "host/io/text.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

namespace fs = std::filesystem;
using sensing::FloatImage;

constexpr double kKittiScale = 256;

/// Middlebury's second version keeps the scale, and the largest disparity, in a file of its own.
double scale_beside(const std::string& path) {
  const std::string info = (fs::path(path).parent_path() / "info.txt").string();
  std::error_code unreadable;
  if (!fs::exists(info, unreadable)) {
    throw Error(
        fmt::format("{}: truth of 8 bits, expected its levels per pixel of disparity (a "
                    "scale, or a file info.txt beside it that begins with it)",
                    path));
  }
  const TextFile file(info);
  if (file.rows().empty()) throw Error(fmt::format("{}: empty, expected a scale", info));
  const double scale = file.number(file.rows()[0], 0);
  if (!(scale > 0)) file.fail(file.rows()[0], "expected a scale above 0");
  return scale;
}

/// Whether the file begins as a PFM does; reading is the readers' business.
bool holds_floats(const std::string& path) {
  return is_pfm(read_file(path));
}

}  // namespace

Truth read_truth(const std::string& path, std::optional<double> scale) {
  Truth truth;
  if (holds_floats(path)) {
    if (scale) throw Error(fmt::format("{}: a PFM file holds pixels, expected no scale", path));
    truth = {read_pfm(path), "PFM"};
  } else {
    const LevelsRead read = read_levels(path);
    if (!scale) scale = read.bits == 16 ? kKittiScale : scale_beside(path);
    truth.disparity = FloatImage(read.levels.width, read.levels.height);
    std::transform(read.levels.pixels.begin(), read.levels.pixels.end(),
                   truth.disparity.pixels.begin(),
                   [&](std::uint16_t level) { return static_cast<float>(level / *scale); });
    truth.format = fmt::format("{} bit, {:g} levels a pixel", read.bits, *scale);
  }
  const auto known = [](float value) { return value > 0; };
  if (std::none_of(truth.disparity.pixels.begin(), truth.disparity.pixels.end(), known)) {
    throw Error(fmt::format("{}: no pixel's disparity is known", path));
  }
  return truth;
}

sensing::GrayImage read_mask(const std::string& path) {
  sensing::GrayImage mask = read_gray(path).image;
  for (std::uint8_t& value : mask.pixels) value = value == 255 ? 255 : 0;
  return mask;
}

}  // namespace partita::io
