// Limits: "power=30W", what no placement may exceed.
#ifndef PARTITA_PARTITION_SEARCH_LIMITS_H
#define PARTITA_PARTITION_SEARCH_LIMITS_H

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "partition/search/objective.h"

namespace partita::partition {

enum class Limited : std::uint8_t { power, price, latency, energy };
inline constexpr std::array kLimited{Limited::power, Limited::price, Limited::latency,
                                     Limited::energy};
std::string_view to_string(Limited what);
/// The figure that is limited: W, USD, ns (p99), J per frame.
double figure(Limited what, const Score& score);
/// "30 W", "1500 USD", "99.5 ms", "2 J".
std::string show(Limited what, double value);

struct Limits {
  std::array<std::optional<double>, kLimited.size()> most;  ///< by Limited, in figure()'s units

  std::optional<double>& operator[](Limited what) { return most[static_cast<std::size_t>(what)]; }
  const std::optional<double>& operator[](Limited what) const {
    return most[static_cast<std::size_t>(what)];
  }
  bool met(const Score& score) const;
  /// How far beyond, 0 if met: the sum of the relative excesses.
  double excess(const Score& score) const;
  /// "power=30 W, latency=100 ms"
  std::string to_string() const;
};

/// Reads "power=30W" into `limits`. Units: mW W kW, USD, ns us ms s, mJ J; without one: W, USD, ms,
/// J. Throws profile::Error for an unknown name or unit, a number that is not above 0, a limit
/// given twice.
void parse_limit(std::string_view text, Limits& limits);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_LIMITS_H
