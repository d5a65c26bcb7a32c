// A drawing as SVG 1.1.
#include <fmt/format.h>

#include "host/app/plot.h"

namespace partita::app::plot {
namespace {

std::string hex(Rgb c) {
  return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// A hundredth of a pixel is enough, and keeps files small and free of rounding noise.
std::string number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string stroke(double width, Rgb colour) {
  if (width <= 0) return "";
  return fmt::format(" stroke=\"{}\" stroke-width=\"{}\"", hex(colour), number(width));
}

template <typename Points>
std::string list(const Points& points) {
  std::string text;
  for (const Point& p : points) {
    text += fmt::format("{}{},{}", text.empty() ? "" : " ", number(p.x), number(p.y));
  }
  return text;
}

std::string to_svg(const Line& line) {
  return fmt::format("<polyline points=\"{}\" fill=\"none\"{}{}/>", list(line.points),
                     stroke(line.width, line.colour),
                     line.dashed ? " stroke-dasharray=\"4 4\"" : "");
}

std::string to_svg(const Box& box) {
  return fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"{}/>",
                     number(box.from.x), number(box.from.y), number(box.width), number(box.height),
                     hex(box.fill), stroke(box.border, box.border_colour));
}

std::string to_svg(const Mark& mark) {
  const std::string style =
      fmt::format("fill=\"{}\"{}", hex(mark.fill), stroke(mark.border, mark.border_colour));
  if (!mark.star) {
    return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {}/>", number(mark.at.x),
                       number(mark.at.y), number(mark.radius), style);
  }
  return fmt::format("<polygon points=\"{}\" {}/>", list(star(mark.at, mark.radius)), style);
}

std::string to_svg(const Text& text) {
  static constexpr const char* kAnchors[] = {"start", "middle", "end"};
  const std::string x = number(text.at.x), y = number(text.at.y);
  std::string style;
  if (text.bold) style += " font-weight=\"bold\"";
  if (text.upright) style += fmt::format(" transform=\"rotate(-90 {} {})\"", x, y);
  return fmt::format(
      "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{}\"{}>{}</text>", x, y,
      number(text.size), kAnchors[static_cast<std::size_t>(text.anchor)], hex(text.colour), style,
      escaped(text.text));
}

}  // namespace

std::string Drawing::to_svg() const {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" "
      "viewBox=\"0 0 {0} {1}\" font-family=\"Helvetica, Arial, Liberation Sans, DejaVu Sans, "
      "sans-serif\">\n<title>{2}</title>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      number(width_), number(height_), escaped(title_));
  for (const Shape& shape : shapes_) {
    svg += std::visit([](const auto& s) { return plot::to_svg(s); }, shape) + "\n";
  }
  return svg + "</svg>\n";
}

}  // namespace partita::app::plot
