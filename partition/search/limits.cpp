#include "partition/search/limits.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <span>

#include "devices/profile/error.h"
#include "partition/text.h"

namespace partita::partition {
namespace {

struct Unit {
  std::string_view name;
  double factor = 1;  ///< to figure()'s unit
};

/// The first one is meant where none is given.
std::span<const Unit> units(Limited what) {
  static constexpr std::array kPower{Unit{"W"}, Unit{"mW", 1e-3}, Unit{"kW", 1e3}};
  static constexpr std::array kPrice{Unit{"USD"}};
  static constexpr std::array kTime{Unit{"ms", 1e6}, Unit{"s", 1e9}, Unit{"us", 1e3}, Unit{"ns"}};
  static constexpr std::array kEnergy{Unit{"J"}, Unit{"mJ", 1e-3}};
  switch (what) {
    case Limited::power:
      return kPower;
    case Limited::price:
      return kPrice;
    case Limited::latency:
      return kTime;
    case Limited::energy:
      return kEnergy;
  }
  return {};
}

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw profile::Error("limit '" + std::string(text) + "': " + why);
}

Limited parse_limited(std::string_view name, std::string_view text) {
  for (const Limited what : kLimited) {
    if (to_string(what) == name) return what;
  }
  refuse(text, "expected one of power, price, latency, energy, for instance power=30W");
}

double factor_of(Limited what, std::string_view unit, std::string_view text) {
  if (unit.empty()) return units(what).front().factor;
  std::string names;
  for (const Unit& known : units(what)) {
    if (known.name == unit) return known.factor;
    append(names, known.name);
  }
  refuse(text, "unit '" + std::string(unit) + "', expected one of " + names);
}

}  // namespace

std::string_view to_string(Limited what) {
  switch (what) {
    case Limited::power:
      return "power";
    case Limited::price:
      return "price";
    case Limited::latency:
      return "latency";
    case Limited::energy:
      return "energy";
  }
  return "?";
}

double figure(Limited what, const Score& score) {
  switch (what) {
    case Limited::power:
      return score.power_w;
    case Limited::price:
      return score.price_usd;
    case Limited::latency:
      return score.p99_ns;
    case Limited::energy:
      return score.energy_j;
  }
  return 0;
}

std::string show(Limited what, double value) {
  const Unit& unit = units(what).front();
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", what == Limited::price ? 0 : 3, value / unit.factor);
  std::string number = text;
  if (number.find('.') != std::string::npos) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
  }
  return number.append(" ").append(unit.name);
}

bool Limits::met(const Score& score) const {
  for (const Limited what : kLimited) {
    if ((*this)[what] && figure(what, score) > *(*this)[what]) return false;
  }
  return true;
}

double Limits::excess(const Score& score) const {
  double sum = 0;
  for (const Limited what : kLimited) {
    const auto& limit = (*this)[what];
    if (limit) sum += std::max(0.0, figure(what, score) / *limit - 1);
  }
  return sum;
}

std::string Limits::to_string() const {
  std::string text;
  for (const Limited what : kLimited) {
    if (!(*this)[what]) continue;
    append(text, std::string(partition::to_string(what)) + "=" + show(what, *(*this)[what]));
  }
  return text;
}

void parse_limit(std::string_view text, Limits& limits) {
  const std::size_t equals = text.find('=');
  const Limited what = parse_limited(trimmed(text.substr(0, equals)), text);
  const std::string_view right =
      equals == std::string_view::npos ? "" : trimmed(text.substr(equals + 1));
  double number = 0;
  const auto [end, error] = std::from_chars(right.data(), right.data() + right.size(), number);
  if (error != std::errc() || !std::isfinite(number)) {
    refuse(text, "no number, expected for instance " + std::string(to_string(what)) + "=30");
  }
  const std::string_view unit = trimmed({end, right.data() + right.size()});
  const double limit = number * factor_of(what, unit, text);
  if (!(limit > 0) || !std::isfinite(limit)) refuse(text, "expected more than 0");
  if (limits[what]) refuse(text, "'" + std::string(to_string(what)) + "' is limited twice");
  limits[what] = limit;
}

}  // namespace partita::partition
