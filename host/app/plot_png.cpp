// A drawing as PNG, by OpenCV: the same on every computer, since its letters are strokes and need
// no font. It has ASCII only.
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/app/plot.h"
#include "host/runtime/error.h"

namespace partita::app::plot {
namespace {

/// Pixels of the picture per pixel of the drawing.
constexpr double kScale = 2;
/// OpenCV takes coordinates in 1 / 2^kShift pixels.
constexpr int kShift = 4;

cv::Scalar bgr(Rgb c) {
  return {static_cast<double>(c.b), static_cast<double>(c.g), static_cast<double>(c.r)};
}

int fixed(double value) {
  return static_cast<int>(std::lround(value * kScale * (1 << kShift)));
}

cv::Point fixed(Point p) {
  // Pixel centres of OpenCV are at whole numbers, those of SVG at halves.
  const double half = 0.5 / kScale;
  return {fixed(p.x - half), fixed(p.y - half)};
}

int thickness(double width) {
  return std::max(1, static_cast<int>(std::lround(width * kScale)));
}

class Raster {
 public:
  Raster(double width, double height)
      : picture_(static_cast<int>(std::lround(height * kScale)),
                 static_cast<int>(std::lround(width * kScale)), CV_8UC3,
                 cv::Scalar(255, 255, 255)) {}

  void operator()(const Line& line) {
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      segment(line.points[i - 1], line.points[i], line);
    }
  }

  void operator()(const Box& box) {
    const Point to{box.from.x + box.width, box.from.y + box.height};
    const std::vector<cv::Point> corners{fixed(box.from), fixed(Point{to.x, box.from.y}), fixed(to),
                                         fixed(Point{box.from.x, to.y})};
    polygon(corners, box.fill, box.border, box.border_colour);
  }

  void operator()(const Mark& mark) {
    if (mark.star) {
      std::vector<cv::Point> corners;
      for (const Point& p : star(mark.at, mark.radius)) corners.push_back(fixed(p));
      return polygon(corners, mark.fill, mark.border, mark.border_colour);
    }
    const auto disc = [&](double radius, Rgb colour) {
      cv::circle(picture_, fixed(mark.at), fixed(radius), bgr(colour), cv::FILLED, cv::LINE_AA,
                 kShift);
    };
    if (mark.border > 0) disc(mark.radius + mark.border / 2, mark.border_colour);
    disc(mark.radius - mark.border / 2, mark.fill);
  }

  void operator()(const Text& text) {
    // A Hershey font's capitals are 21 units high, a sans-serif font's 0.72 of its size.
    const double scale = text.size * kScale * 0.72 / 21;
    const int stroke = std::max(1, static_cast<int>(std::lround(scale * (text.bold ? 2.8 : 1.9))));
    int base = 0;
    const cv::Size size = cv::getTextSize(text.text, kFont, scale, stroke, &base);
    const double shift = text.anchor == Anchor::start    ? 0
                         : text.anchor == Anchor::middle ? size.width / 2.0
                                                         : size.width;
    const cv::Point at(static_cast<int>(std::lround(text.at.x * kScale)),
                       static_cast<int>(std::lround(text.at.y * kScale)));
    if (text.upright) return upright(text, scale, stroke, size, base, at, shift);
    const cv::Point left(at.x - static_cast<int>(std::lround(shift)), at.y);
    cv::putText(picture_, text.text, left, kFont, scale, bgr(text.colour), stroke, cv::LINE_AA);
  }

  std::string png() const {
    std::vector<std::uint8_t> bytes;
    if (!cv::imencode(".png", picture_, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6}))
      throw Error("a plot cannot be encoded as PNG");
    return {bytes.begin(), bytes.end()};
  }

 private:
  static constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

  void polygon(const std::vector<cv::Point>& corners, Rgb fill, double border, Rgb border_colour) {
    cv::fillPoly(picture_, std::vector<std::vector<cv::Point>>{corners}, bgr(fill), cv::LINE_AA,
                 kShift);
    if (border <= 0) return;
    cv::polylines(picture_, std::vector<std::vector<cv::Point>>{corners}, true, bgr(border_colour),
                  thickness(border), cv::LINE_AA, kShift);
  }

  void segment(Point from, Point to, const Line& line) {
    const auto draw = [&](Point a, Point b) {
      cv::line(picture_, fixed(a), fixed(b), bgr(line.colour), thickness(line.width), cv::LINE_AA,
               kShift);
    };
    if (!line.dashed) return draw(from, to);
    constexpr double kDash = 4;
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const auto at = [&](double way) {
      const double share = std::min(1.0, way / length);
      return Point{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
    };
    for (double way = 0; way < length; way += 2 * kDash) draw(at(way), at(way + kDash));
  }

  /// OpenCV writes from left to right only: the text is written aside, turned and laid over.
  void upright(const Text& text, double scale, int stroke, cv::Size size, int base, cv::Point at,
               double shift) {
    const int pad = stroke + 2;
    cv::Mat flat(size.height + base + 2 * pad, size.width + 2 * pad, CV_8UC3, bgr(kWhite));
    cv::putText(flat, text.text, {pad, size.height + pad}, kFont, scale, bgr(text.colour), stroke,
                cv::LINE_AA);
    cv::Mat turned;
    cv::rotate(flat, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
    const cv::Rect place(at.x - size.height - pad,
                         at.y - size.width - pad + static_cast<int>(std::lround(shift)),
                         turned.cols, turned.rows);
    const cv::Rect seen = place & cv::Rect(0, 0, picture_.cols, picture_.rows);
    cv::Mat target = picture_(seen);
    cv::min(target, turned(seen - place.tl()), target);
  }

  cv::Mat picture_;
};

}  // namespace

std::string Drawing::to_png() const {
  Raster raster(width_, height_);
  for (const Shape& shape : shapes_) std::visit(raster, shape);
  return raster.png();
}

}  // namespace partita::app::plot
