#include "partition/search/compare.h"

#include <algorithm>

#include "partition/search/sanity.h"
#include "partition/search/usage.h"

namespace partita::partition {
namespace {

/// Up to so many parts in common all combinations of slow and fast are tried: 16 at most.
constexpr std::size_t kAllCorners = 4;

double slow(const Part& part) {
  return 1 / (1 + part.uncertainty);
}
double fast(const Part& part) {
  return 1 / (1 - part.uncertainty);
}

bool has(const std::vector<Part>& parts, const Part& part) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const Part& other) { return other.name == part.name; });
}

/// Which of `count` parts are slow, corner by corner; the others are fast, or as declared.
struct Scheme {
  std::vector<std::vector<double>> speeds;  ///< by corner and part
};

Scheme scheme(const std::vector<Part>& common) {
  const std::size_t count = common.size();
  Scheme result;
  if (count <= kAllCorners) {
    for (std::size_t bits = 0; bits < std::size_t{1} << count; ++bits) {
      auto& speeds = result.speeds.emplace_back();
      for (std::size_t i = 0; i < count; ++i) {
        speeds.push_back((bits >> i & 1) != 0 ? fast(common[i]) : slow(common[i]));
      }
    }
    return result;
  }
  for (double (*speed)(const Part&) : {&slow, &fast}) {
    auto& all = result.speeds.emplace_back();
    for (const Part& part : common) all.push_back(speed(part));
    for (std::size_t i = 0; i < count; ++i) {
      result.speeds.emplace_back(count, 1.0)[i] = speed(common[i]);
    }
  }
  return result;
}

/// Speeds of the machine's parts with a profile's factor on everything built from it.
Speeds speeds_of(const profile::Machine& machine, const std::map<std::string, double>& corner) {
  const auto factor = [&](const std::string& name) {
    const auto found = corner.find(name);
    return found == corner.end() ? 1.0 : found->second;
  };
  Speeds speeds = as_declared(machine);
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    speeds.devices[d] = speeds.buses[d] = factor(machine.devices[d].profile.id);
  }
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    speeds.nodes[n] = factor(machine.nodes[n].host.id);
  }
  for (std::size_t l = 0; l < machine.links.size(); ++l) {
    speeds.links[l] = factor(machine.links[l].name);
  }
  return speeds;
}

Choices only(const TaskPlacement& placement) {
  Choices choices;
  for (const std::uint32_t place : placement) choices.push_back({place});
  return choices;
}

/// Scores of both in each corner.
struct Sides {
  std::vector<Score> a, b;
};

Comparison compared(const Sides& sides, Objective by) {
  Comparison result;
  result.by = by;
  result.beats = true;
  result.corners = sides.a.size();
  result.dropped = sides.b.front().dropped - sides.a.front().dropped;
  for (std::size_t i = 0; i < sides.a.size(); ++i) {
    const double difference = value(by, sides.b[i]) - value(by, sides.a[i]);
    const auto key = [by](const Score& s) { return std::make_pair(s.dropped, cost(by, s)); };
    result.beats = result.beats && key(sides.a[i]) < key(sides.b[i]);
    if (i == 0) result.nominal = result.least = result.most = difference;
    result.least = std::min(result.least, difference);
    result.most = std::max(result.most, difference);
  }
  return result;
}

}  // namespace

std::vector<Part> parts(const Evaluator& evaluator, const TaskPlacement& placement) {
  const profile::Machine& machine = evaluator.machine();
  const Usage used = usage(evaluator, placement);
  std::vector<Part> result;
  const auto add = [&](const std::string& name, const std::optional<double>& stated) {
    const Part part{name, stated.value_or(profile::kDefaultUncertainty), !stated};
    if (!has(result, part)) result.push_back(part);
  };
  for (std::size_t d = 0; d < machine.devices.size(); ++d) {
    const profile::DeviceProfile& device = machine.devices[d].profile;
    if (used.devices[d]) add(device.id, device.uncertainty);
  }
  for (std::size_t n = 0; n < machine.nodes.size(); ++n) {
    if (used.nodes[n]) add(machine.nodes[n].host.id, machine.nodes[n].host.uncertainty);
  }
  for (std::size_t l = 0; l < machine.links.size(); ++l) {
    if (used.links[l]) add(machine.links[l].name, machine.links[l].uncertainty);
  }
  return result;
}

const Score& Comparer::score(const Evaluator& on, const TaskPlacement& placement,
                             const Corner& corner) {
  Scaled& scaled = scaled_[{&on, corner}];
  if (!scaled.evaluator) scaled.evaluator = on.with(speeds_of(on.machine(), corner));
  const auto [found, missing] = scaled.scores.try_emplace(placement);
  if (missing) {
    const Evaluator& evaluator = *scaled.evaluator;
    const Figures figures = evaluator.quick(placement);
    const Bounds bounds = Bounder(evaluator, only(placement), drops_of(figures))(placement);
    found->second = score_of(evaluator, placement, figures, bounds);
  }
  return found->second;
}

Comparison Comparer::compare(const Evaluator& on_a, const TaskPlacement& a, const Evaluator& on_b,
                             const TaskPlacement& b) {
  const std::vector<Part> parts_a = parts(on_a, a), parts_b = parts(on_b, b);
  std::vector<Part> common;
  Corner worst;
  for (const Part& part : parts_a) {
    if (has(parts_b, part)) {
      common.push_back(part);
    } else {
      worst[part.name] = slow(part);
    }
  }
  for (const Part& part : parts_b) {
    if (!has(parts_a, part)) worst[part.name] = fast(part);
  }
  Sides sides;
  const auto add = [&](const Corner& corner) {
    sides.a.push_back(score(on_a, a, corner));
    sides.b.push_back(score(on_b, b, corner));
  };
  add({});
  for (const std::vector<double>& speeds : scheme(common).speeds) {
    Corner corner = worst;
    for (std::size_t i = 0; i < common.size(); ++i) corner[common[i].name] = speeds[i];
    add(corner);
  }
  const Comparison comparison = compared(sides, objective_);
  const bool same = comparison.least == 0 && comparison.most == 0;
  return same ? compared(sides, Objective::latency) : comparison;
}

}  // namespace partita::partition
