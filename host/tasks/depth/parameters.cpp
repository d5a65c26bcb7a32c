#include "host/tasks/depth/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/runtime/error.h"
#include "host/tasks/depth/geometry.h"

namespace partita::depth {
namespace {

using P = DepthParameters;

template <auto Member>
constexpr Parameter entry(std::string_view name, std::string_view unit, double least, double most,
                          std::string_view meaning) {
  using Value = std::remove_cvref_t<decltype(P{}.*Member)>;
  constexpr ParameterKind kKind = std::is_same_v<Value, bool>     ? ParameterKind::flag
                                  : std::is_same_v<Value, double> ? ParameterKind::real
                                                                  : ParameterKind::integer;
  return {name,
          unit,
          kKind,
          least,
          most,
          meaning,
          [](const P& p) { return static_cast<double>(p.*Member); },
          [](P& p, double value) { p.*Member = static_cast<Value>(value); }};
}

template <auto Member>
constexpr Parameter flag(std::string_view name, std::string_view meaning) {
  return entry<Member>(name, "", 0, 1, meaning);
}

constexpr Parameter kParameters[] = {
    entry<&P::max_disparity>("max_disparity", "px", 15, kLargestDisparity,
                             "largest disparity searched; below the pictures' width"),
    entry<&P::candidate_step>("candidate_step", "px", 5, 32,
                              "pitch of the grid on which support points are sought"),
    entry<&P::support_threshold>("support_threshold", "", 0.01, 1,
                                 "tau: a support point's best cost is below this share of the "
                                 "second best"),
    entry<&P::support_texture>("support_texture", "grey levels", 0, 2048,
                               "least texture, sum of |descriptor - 128|, of a support point"),
    entry<&P::incon_window>("incon_window", "grid steps", 1, kLargestWindow,
                            "neighbourhood in which a support point needs others that agree"),
    entry<&P::incon_threshold>("incon_threshold", "px", 0, 255,
                               "largest difference of support points that agree"),
    entry<&P::incon_min_support>("incon_min_support", "points", 1, 1000,
                                 "support points that have to agree, the point itself included"),
    entry<&P::redun_max_distance>("redun_max_distance", "grid steps", 1, 16,
                                  "how far to either side a redundant point's neighbours may be"),
    entry<&P::redun_threshold>("redun_threshold", "px", 0, 255,
                               "largest difference of a redundant point to those neighbours"),
    flag<&P::add_corners>("add_corners",
                          "support points at the pictures' corners, with the nearest disparity"),
    entry<&P::grid_size>("grid_size", "px", kSmallestCell, kLargestCell,
                         "side of the cells that list the disparities seen in them and around"),
    entry<&P::beta>("beta", "", 0.001, 1, "weight of the descriptors' distance"),
    entry<&P::gamma>("gamma", "", 0.01, 100, "the prior's uniform share"),
    entry<&P::sigma>("sigma", "px", 0.1, 10, "the prior's spread around a plane"),
    entry<&P::sradius>("sradius", "sigma", 0.1, 10,
                       "disparities this near to a plane are tried; sigma * sradius <= 16"),
    entry<&P::match_texture>("match_texture", "grey levels", 0, 2048,
                             "least texture, sum of |descriptor - 128|, of a pixel to be matched"),
    entry<&P::lr_threshold>("lr_threshold", "px", 0, 255,
                            "largest difference of the two views' disparities"),
    entry<&P::speckle_similarity>("speckle_similarity", "px", 0, 255,
                                  "neighbours that differ by at most this are of one segment"),
    entry<&P::speckle_size>("speckle_size", "px", 0, kLargestSide* kLargestSide,
                            "segments of fewer pixels are removed"),
    entry<&P::ipol_gap_width>("ipol_gap_width", "px", 0, 2 * kLargestSide,
                              "gaps up to this width are filled; with add_corners to the border"),
    flag<&P::filter_adaptive_mean>("filter_adaptive_mean",
                                   "smooths disparities without crossing their edges"),
    flag<&P::filter_median>("filter_median", "median over 7 x 7 pixels, along rows and columns"),
};

[[noreturn]] void refuse(const Parameter& parameter, std::string_view value) {
  const std::string_view kind = parameter.kind == ParameterKind::flag      ? "on or off"
                                : parameter.kind == ParameterKind::integer ? "a whole number "
                                                                           : "a number ";
  std::string range;
  if (parameter.kind != ParameterKind::flag) {
    range = fmt::format("from {} to {}", parameter.least, parameter.most);
  }
  throw Error(fmt::format("depth: {} is {}, expected {}{}{}{}", parameter.name, value, kind, range,
                          parameter.unit.empty() ? "" : " ", parameter.unit));
}

double parse_flag(const Parameter& parameter, std::string_view value) {
  for (const std::string_view yes : {"on", "true", "yes", "1"}) {
    if (value == yes) return 1;
  }
  for (const std::string_view no : {"off", "false", "no", "0"}) {
    if (value == no) return 0;
  }
  refuse(parameter, fmt::format("'{}'", value));
}

double parse_number(const Parameter& parameter, std::string_view value) {
  double number = 0;
  const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), number);
  const bool whole = parameter.kind == ParameterKind::real || number == std::floor(number);
  if (code != std::errc() || end != value.data() + value.size() || !whole) {
    refuse(parameter, fmt::format("'{}'", value));
  }
  return number;
}

void check_range(const Parameter& parameter, double value) {
  if (value >= parameter.least && value <= parameter.most) return;  // a NaN is neither
  refuse(parameter, fmt::format("{}", value));
}

}  // namespace

DepthParameters setting(std::string_view name) {
  if (name == "robotics") return {};
  if (name == "middlebury") {
    return {.support_threshold = 0.95,
            .add_corners = true,
            .gamma = 5,
            .sradius = 3,
            .match_texture = 0,
            .ipol_gap_width = 5000,
            .filter_adaptive_mean = false,
            .filter_median = true};
  }
  throw Error(
      fmt::format("depth: no setting '{}', expected one of {}", name, fmt::join(kSettings, ", ")));
}

DepthParameters default_parameters(int width) {
  DepthParameters parameters;
  parameters.max_disparity = std::min(parameters.max_disparity, width - 1);
  return parameters;
}

std::span<const Parameter> parameter_table() {
  return kParameters;
}

void set_parameter(DepthParameters& parameters, std::string_view name, std::string_view value) {
  for (const Parameter& parameter : kParameters) {
    if (parameter.name != name) continue;
    const bool is_flag = parameter.kind == ParameterKind::flag;
    const double number = is_flag ? parse_flag(parameter, value) : parse_number(parameter, value);
    check_range(parameter, number);
    parameter.set(parameters, number);
    return;
  }
  std::vector<std::string_view> names;
  for (const Parameter& parameter : kParameters) names.push_back(parameter.name);
  throw Error(
      fmt::format("depth: no parameter '{}', expected one of {}", name, fmt::join(names, ", ")));
}

std::string value_text(const Parameter& parameter, const DepthParameters& parameters) {
  const double value = parameter.get(parameters);
  if (parameter.kind == ParameterKind::flag) return value != 0 ? "on" : "off";
  return fmt::format("{}", value);
}

void check_parameters(const DepthParameters& parameters) {
  for (const Parameter& parameter : kParameters) check_range(parameter, parameter.get(parameters));
  if (parameters.sigma * parameters.sradius > kLargestRadius) {
    throw Error(fmt::format("depth: sigma {} times sradius {} is {} px, expected at most {}",
                            parameters.sigma, parameters.sradius,
                            parameters.sigma * parameters.sradius, kLargestRadius));
  }
}

int plane_radius(const DepthParameters& parameters) {
  return std::max(2, static_cast<int>(std::ceil(parameters.sigma * parameters.sradius)));
}

}  // namespace partita::depth
