#include "partition/search/objective.h"

#include <cstdio>
#include <tuple>

#include "devices/profile/error.h"

namespace partita::partition {

std::string_view to_string(Objective objective) {
  switch (objective) {
    case Objective::latency:
      return "latency";
    case Objective::energy:
      return "energy";
    case Objective::throughput:
      return "throughput";
    case Objective::cost:
      return "cost";
  }
  return "?";
}

Objective parse_objective(std::string_view text) {
  for (const Objective objective : kObjectives) {
    if (to_string(objective) == text) return objective;
  }
  throw profile::Error("objective '" + std::string(text) +
                       "': expected one of latency, energy, throughput, cost");
}

double value(Objective objective, const Score& score) {
  return convert(objective, cost(objective, score));
}

double cost(Objective objective, const Score& score) {
  switch (objective) {
    case Objective::latency:
      return score.p99_ns;
    case Objective::energy:
      return score.energy_j;
    case Objective::throughput:
      return score.frame_ns;
    case Objective::cost:
      return score.price_usd;
  }
  return 0;
}

double convert(Objective objective, double cost) {
  return objective == Objective::throughput ? 1e9 / cost : cost;
}

std::string show(Objective objective, double value) {
  char text[64];
  switch (objective) {
    case Objective::latency:
      std::snprintf(text, sizeof text, "%.2f ms", value * 1e-6);
      break;
    case Objective::energy:
      std::snprintf(text, sizeof text, "%.3f J", value);
      break;
    case Objective::throughput:
      std::snprintf(text, sizeof text, "%.2f Hz", value);
      break;
    case Objective::cost:
      std::snprintf(text, sizeof text, "%.0f USD", value);
      break;
  }
  return text;
}

bool ranks_before(Objective objective, const Score& a, const Score& b) {
  const auto key = [&](const Score& s) {
    return std::make_tuple(s.dropped, cost(objective, s), s.p99_ns, s.energy_j, s.price_usd,
                           s.p50_ns);
  };
  return key(a) < key(b);
}

}  // namespace partita::partition
