#include "host/io/image.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/io/file.h"
#include "host/io/image_check.h"
#include "host/io/pfm.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

using sensing::ColourImage;
using sensing::FloatImage;
using sensing::GrayImage;

/// What goes wrong is reported once, by our Error; OpenCV's own log would only repeat it.
void silence_opencv() {
  static std::once_flag once;
  std::call_once(once,
                 [] { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); });
}

/// The bytes of a file that holds a whole picture.
std::string read_picture(const std::string& path) {
  std::string bytes = read_file(path);
  if (const std::string defect = image_defect(bytes); !defect.empty()) {
    throw Error(fmt::format("{}: picture is {}", path, defect));
  }
  return bytes;
}

cv::Mat decode(const std::string& path) {
  silence_opencv();
  const std::string bytes = read_picture(path);
  const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  cv::Mat image;
  try {
    image = cv::imdecode(raw, cv::IMREAD_UNCHANGED | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) throw Error(fmt::format("{}: picture is damaged (cannot be decoded)", path));
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw Error(fmt::format("{}: neither 8 nor 16 bits per sample", path));
  }
  return image;
}

/// Speed over size: a run writes thousands of these.
void encode_png(const std::string& path, const cv::Mat& image) {
  silence_opencv();
  std::vector<std::uint8_t> bytes;
  const std::vector<int> options = {cv::IMWRITE_PNG_COMPRESSION, 1};
  try {
    if (!cv::imencode(".png", image, bytes, options)) bytes.clear();
  } catch (const cv::Exception&) {
    bytes.clear();
  }
  if (bytes.empty()) throw Error(fmt::format("cannot write '{}': not encodable as PNG", path));
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

template <class Sample>
void to_gray(const cv::Mat& image, int shift, GrayImage& out) {
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const Sample* in = image.ptr<Sample>(y);
    std::uint8_t* row = out.row(y);
    for (int x = 0; x < image.cols; ++x, in += channels) {
      const std::uint32_t value =
          channels < 3 ? in[0] : (1868U * in[0] + 9617U * in[1] + 4899U * in[2] + 8192U) >> 14;
      row[x] = static_cast<std::uint8_t>(value >> shift);
    }
  }
}

template <class Sample>
void to_levels(const std::string& path, const cv::Mat& image, sensing::Image<std::uint16_t>& out) {
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const Sample* in = image.ptr<Sample>(y);
    for (int x = 0; x < image.cols; ++x, in += channels) {
      if (channels >= 3 && (in[0] != in[1] || in[1] != in[2])) {
        throw Error(fmt::format("{}: has colours, expected a picture of one channel", path));
      }
      out.at(x, y) = in[0];
    }
  }
}

template <class Sample>
void to_colour(const cv::Mat& image, int shift, ColourImage& out) {
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const Sample* in = image.ptr<Sample>(y);
    sensing::Rgb* row = out.row(y);
    for (int x = 0; x < image.cols; ++x, in += channels) {
      const bool gray = channels < 3;
      row[x] = {static_cast<std::uint8_t>(in[gray ? 0 : 2] >> shift),
                static_cast<std::uint8_t>(in[gray ? 0 : 1] >> shift),
                static_cast<std::uint8_t>(in[0] >> shift)};
    }
  }
}

/// The name's ending in small letters: ".png".
std::string ending(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// A copy of the picture with a strip below: the colour scale with its ends and middle labelled.
cv::Mat with_colour_bar(const cv::Mat& picture, double max_disparity) {
  constexpr int kStrip = 44;
  constexpr int kMargin = 12;
  cv::Mat out(picture.rows + kStrip, picture.cols, CV_8UC3, cv::Scalar::all(255));
  picture.copyTo(out.rowRange(0, picture.rows));
  const int width = std::max(1, picture.cols - 2 * kMargin);
  cv::Mat ramp(14, width, CV_8U);
  for (int x = 0; x < width; ++x) ramp.col(x).setTo(255 * x / std::max(1, width - 1));
  cv::applyColorMap(ramp, ramp, cv::COLORMAP_JET);
  const cv::Rect place(kMargin, picture.rows + 6, width, ramp.rows);
  if (place.x + place.width <= out.cols) ramp.copyTo(out(place));
  for (int i = 0; i <= 2; ++i) {
    const std::string label = fmt::format("{:g}{}", max_disparity * i / 2, i == 2 ? " px" : "");
    const int text_width = cv::getTextSize(label, cv::FONT_HERSHEY_SIMPLEX, 0.45, 1, nullptr).width;
    const cv::Point at(kMargin + (width - text_width) * i / 2, picture.rows + kStrip - 8);
    cv::putText(out, label, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar::all(0), 1, cv::LINE_AA);
  }
  return out;
}

}  // namespace

GrayRead read_gray(const std::string& path) {
  const cv::Mat image = decode(path);
  GrayRead result;
  result.image = GrayImage(image.cols, image.rows);
  if (image.channels() >= 3) result.converted = "colour";
  if (image.depth() == CV_16U)
    result.converted = result.converted.empty() ? "16-bit" : "16-bit colour";
  if (image.depth() == CV_16U) {
    to_gray<std::uint16_t>(image, 8, result.image);
  } else {
    to_gray<std::uint8_t>(image, 0, result.image);
  }
  return result;
}

LevelsRead read_levels(const std::string& path) {
  const cv::Mat image = decode(path);
  LevelsRead result;
  result.levels = sensing::Image<std::uint16_t>(image.cols, image.rows);
  if (image.depth() == CV_16U) {
    result.bits = 16;
    to_levels<std::uint16_t>(path, image, result.levels);
  } else {
    to_levels<std::uint8_t>(path, image, result.levels);
  }
  return result;
}

ColourImage read_colour(const std::string& path) {
  const cv::Mat image = decode(path);
  ColourImage result(image.cols, image.rows);
  if (image.depth() == CV_16U) {
    to_colour<std::uint16_t>(image, 8, result);
  } else {
    to_colour<std::uint8_t>(image, 0, result);
  }
  return result;
}

void check_picture(const std::string& path) {
  read_picture(path);
}

void write_colour(const std::string& path, const ColourImage& image) {
  static_assert(sizeof(sensing::Rgb) == 3);
  cv::Mat bgr;
  cv::cvtColor(
      cv::Mat(image.height, image.width, CV_8UC3, const_cast<sensing::Rgb*>(image.pixels.data())),
      bgr, cv::COLOR_RGB2BGR);
  encode_png(path, bgr);
}

void write_gray(const std::string& path, const GrayImage& image) {
  encode_png(path, cv::Mat(image.height, image.width, CV_8U,
                           const_cast<std::uint8_t*>(image.pixels.data())));
}

void write_disparity(const std::string& path, const FloatImage& disparity) {
  cv::Mat out(disparity.height, disparity.width, CV_16U);
  for (int y = 0; y < disparity.height; ++y) {
    std::uint16_t* row = out.ptr<std::uint16_t>(y);
    for (int x = 0; x < disparity.width; ++x) {
      const float value = disparity.at(x, y) * 256.0F;  // exact: a power of two
      const bool valid = std::isfinite(value) && value > 0;
      row[x] = valid ? static_cast<std::uint16_t>(std::min(value + 0.5F, 65535.0F)) : 0;
    }
  }
  encode_png(path, out);
}

FloatImage read_disparity(const std::string& path) {
  const cv::Mat image = decode(path);
  if (image.type() != CV_16UC1) {
    throw Error(fmt::format("{}: not a disparity map, expected a 16-bit gray PNG", path));
  }
  FloatImage result(image.cols, image.rows);
  for (int y = 0; y < image.rows; ++y) {
    const std::uint16_t* row = image.ptr<std::uint16_t>(y);
    for (int x = 0; x < image.cols; ++x) result.at(x, y) = static_cast<float>(row[x]) / 256.0F;
  }
  return result;
}

bool is_disparity_name(const std::string& path) {
  return ending(path) == ".png" || ending(path) == ".pfm";
}

void write_disparity_as(const std::string& path, const FloatImage& disparity) {
  if (!is_disparity_name(path)) {
    throw Error(fmt::format("cannot write '{}': expected a name that ends in .png or .pfm", path));
  }
  if (ending(path) == ".pfm") {
    write_pfm(path, disparity);
  } else {
    write_disparity(path, disparity);
  }
}

void write_disparity_picture(const std::string& path, const FloatImage& disparity,
                             double max_disparity) {
  cv::Mat scaled(disparity.height, disparity.width, CV_8U);
  cv::Mat none(disparity.height, disparity.width, CV_8U);
  const double scale = max_disparity > 0 ? 255.0 / max_disparity : 0.0;
  for (int y = 0; y < disparity.height; ++y) {
    for (int x = 0; x < disparity.width; ++x) {
      const float value = disparity.at(x, y);
      const bool valid = std::isfinite(value) && value > 0;
      none.at<std::uint8_t>(y, x) = valid ? 0 : 255;
      scaled.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(valid ? value * scale : 0.0);
    }
  }
  cv::Mat coloured;
  cv::applyColorMap(scaled, coloured, cv::COLORMAP_JET);
  coloured.setTo(cv::Scalar::all(0), none);
  encode_png(path, with_colour_bar(coloured, max_disparity));
}

}  // namespace partita::io
