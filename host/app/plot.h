// Drawing: lines, boxes, discs and text on a white page, in pixels from the top left. The same
// shapes become an SVG, for documents, and a PNG, for everything else.
#ifndef PARTITA_HOST_APP_PLOT_H
#define PARTITA_HOST_APP_PLOT_H

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace partita::app::plot {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};
/// `share` of the way to white.
Rgb lighter(Rgb colour, double share);

inline constexpr Rgb kBlack{0, 0, 0}, kWhite{255, 255, 255}, kInk{38, 38, 38}, kGrey{110, 110, 110},
    kLight{208, 208, 208}, kGrid{232, 232, 232};
/// Okabe and Ito's colours ("Color Universal Design", 2008), which people of any colour vision tell
/// apart; black last, and grey beyond.
Rgb series(std::size_t number);

struct Point {
  double x = 0, y = 0;
};

struct Line {
  std::vector<Point> points;
  Rgb colour = kInk;
  double width = 1;
  bool dashed = false;
};
struct Box {
  Point from;
  double width = 0, height = 0;
  Rgb fill = kWhite;
  double border = 0;  ///< 0: none
  Rgb border_colour = kInk;
};
/// A polygon or, without corners, a disc.
struct Mark {
  Point at;
  double radius = 4;
  Rgb fill = kInk;
  double border = 0;
  Rgb border_colour = kWhite;
  bool star = false;
};
enum class Anchor : std::uint8_t { start, middle, end };
struct Text {
  Point at;  ///< of its base line
  std::string text;
  double size = 14;  ///< px, as CSS
  Anchor anchor = Anchor::start;
  Rgb colour = kInk;
  bool bold = false;
  bool upright = false;  ///< turned by 90 degrees, read from below
};
using Shape = std::variant<Line, Box, Mark, Text>;

/// Roughly what the text takes; fonts differ.
double text_width(const std::string& text, double size);

class Drawing {
 public:
  Drawing(double width, double height, std::string title)
      : width_(width), height_(height), title_(std::move(title)) {}

  void add(Shape shape) { shapes_.push_back(std::move(shape)); }
  double width() const { return width_; }
  double height() const { return height_; }

  std::string to_svg() const;
  /// Twice as many pixels either way. Throws Error if it cannot be encoded.
  std::string to_png() const;
  /// FOLDER/NAME.svg and .png.
  void write(const std::string& folder, const std::string& name) const;

 private:
  double width_, height_;
  std::string title_;  ///< for who cannot see it
  std::vector<Shape> shapes_;
};

/// Corners of a star with five points.
std::array<Point, 10> star(Point at, double radius);

}  // namespace partita::app::plot

#endif  // PARTITA_HOST_APP_PLOT_H
