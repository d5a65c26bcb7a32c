#include "host/io/bal.h"

#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io {
namespace {

constexpr double kLargest = 1e15;

/// Words one after the other, with the lines they stand in.
class Scanner {
 public:
  explicit Scanner(const std::string& path) : path_(path), text_(read_file(path)) {}

  std::size_t bytes() const { return text_.size(); }
  std::size_t line() const { return line_; }

  /// The next word, empty at the end.
  std::string_view word() {
    while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return std::string_view(text_).substr(begin, at_ - begin);
  }

  /// A whole number from `least` to `most`. `what` and `index`: what it is, for a message.
  long whole(const char* what, long least, long most) {
    const std::string_view text = need_word(what);
    long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      fail(fmt::format("{} where {} was expected, a whole number", quoted(text), what));
    }
    if (value < least || value > most) {
      fail(fmt::format("{} {}, expected {} to {}", what, value, least, most));
    }
    return value;
  }

  double real(const char* what) {
    std::string_view text = need_word(what);
    const std::string_view shown = text;
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range && end == text.data() + text.size()) {
      value = std::strtod(std::string(text).c_str(), nullptr);  // an underflow is a plain zero
    } else if (error != std::errc() || end != text.data() + text.size()) {
      fail(fmt::format("{} is not a number, expected {}", quoted(shown), what));
    }
    if (!(std::abs(value) <= kLargest)) {
      fail(fmt::format("{} where a finite number was expected, {}", quoted(shown), what));
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(fmt::format("{}:{}: {}", path_, line_, message));
  }

  static std::string quoted(std::string_view word) {
    std::string out;
    for (const char c : word.substr(0, 24)) out += (c >= 0x20 && c < 0x7f) ? c : '?';
    return "'" + out + (word.size() > 24 ? "...'" : "'");
  }

 private:
  static bool is_blank(char c) {
    return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
  }
  std::string_view need_word(const char* what) {
    const std::string_view text = word();
    if (text.empty())
      fail(fmt::format("the file is cut short: it ends where {} was expected", what));
    return text;
  }

  std::string path_;
  std::string text_;
  std::size_t at_ = 0, line_ = 1;
};

Eigen::Vector3d in_camera(const BalProblem& problem, const BalObservation& o) {
  const auto& c = problem.cameras[static_cast<std::size_t>(o.camera)];
  const auto& p = problem.points[static_cast<std::size_t>(o.point)];
  const Eigen::Vector3d w(c[0], c[1], c[2]);
  const double angle = w.norm();
  const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(w / angle) : Eigen::Vector3d::UnitX();
  return Eigen::AngleAxisd(angle, axis) * Eigen::Vector3d(p[0], p[1], p[2]) +
         Eigen::Vector3d(c[3], c[4], c[5]);
}

}  // namespace

BalProblem read_bal(const std::string& path) {
  Scanner in(path);
  // A number takes at least two characters: what a file of this size cannot hold is not allocated.
  const auto most = static_cast<long>(std::min<std::size_t>(in.bytes() / 2 + 1, 1u << 30));
  const auto cameras = static_cast<std::size_t>(in.whole("the number of cameras", 1, most));
  const auto points = static_cast<std::size_t>(in.whole("the number of points", 1, most));
  const auto observations =
      static_cast<std::size_t>(in.whole("the number of observations", 1, most));
  BalProblem problem;
  problem.observations.resize(observations);
  problem.lines.resize(observations);
  for (std::size_t i = 0; i < observations; ++i) {
    BalObservation& o = problem.observations[i];
    o.camera =
        static_cast<int>(in.whole("an observation's camera", 0, static_cast<long>(cameras) - 1));
    problem.lines[i] = in.line();
    o.point =
        static_cast<int>(in.whole("an observation's point", 0, static_cast<long>(points) - 1));
    o.x = in.real("an observation's x");
    o.y = in.real("an observation's y");
  }
  problem.cameras.resize(cameras);
  for (auto& camera : problem.cameras) {
    for (double& value : camera) value = in.real("one of a camera's nine numbers");
  }
  problem.points.resize(points);
  for (auto& point : problem.points) {
    for (double& value : point) value = in.real("one of a point's three coordinates");
  }
  if (const std::string_view more = in.word(); !more.empty()) {
    in.fail(fmt::format("{} behind the last point, expected the end of the file",
                        Scanner::quoted(more)));
  }
  return problem;
}

void write_bal(const std::string& path, const BalProblem& problem) {
  std::string text = fmt::format("{} {} {}\n", problem.cameras.size(), problem.points.size(),
                                 problem.observations.size());
  const auto out = std::back_inserter(text);
  for (const BalObservation& o : problem.observations) {
    fmt::format_to(out, "{} {} {} {}\n", o.camera, o.point, o.x, o.y);
  }
  for (const auto& camera : problem.cameras) {
    for (const double value : camera) fmt::format_to(out, "{}\n", value);
  }
  for (const auto& point : problem.points) {
    for (const double value : point) fmt::format_to(out, "{}\n", value);
  }
  write_file(path, text);
}

Behind find_behind(const BalProblem& problem) {
  Behind behind;
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    if (in_camera(problem, problem.observations[i]).z() < 0) continue;
    if (behind.count++ == 0) behind.first = i;
  }
  return behind;
}

}  // namespace partita::io
