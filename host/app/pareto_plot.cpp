// pareto.svg, pareto.png: latency against energy of everything that was simulated. What nothing
// beats is in colour, by the parts in use (of several machines: by machine), the rest is pale.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/app/explore.h"
#include "host/app/plot_axis.h"

namespace partita::app {
namespace {

using partition::MachineResult;
using partition::Score;
using plot::Anchor;
using plot::Point;

constexpr double kWidth = 1220, kHeight = 680, kLeft = 88, kRight = 880, kTop = 76, kBottom = 612;

struct Group {
  std::string name;
  double least_usd = 0, most_usd = 0;
  std::size_t shown = 0;
};

struct Plotted {
  Score score;
  std::size_t group = 0;
};

class ParetoPlot {
 public:
  explicit ParetoPlot(const ExploreReport& report)
      : report_(report), drawing_(kWidth, kHeight, title()) {
    for (const MachineResult& result : report.exploration.machines) collect(result);
    name_groups();
  }

  plot::Drawing draw() {
    const auto [x, y] = axes();
    frame(x, y);
    for (const Plotted& p : dominated_) {
      mark(x, y, p.score, several() ? plot::lighter(plot::series(p.group), 0.75) : plot::kLight,
           2.5);
    }
    staircase(x, y);
    for (const Plotted& p : front_) {
      const plot::Rgb colour = plot::series(p.group);
      const bool complete = p.score.dropped == 0;
      drawing_.add(plot::Mark{.at = at(x, y, p.score),
                              .radius = 5.5,
                              .fill = complete ? colour : plot::kWhite,
                              .border = complete ? 1.0 : 2.0,
                              .border_colour = complete ? plot::kWhite : colour});
    }
    best(x, y);
    legend();
    return drawing_;
  }

 private:
  bool several() const { return report_.exploration.machines.size() > 1; }

  std::string title() const {
    const partition::Pipeline& pipeline = report_.pipeline;
    return fmt::format("Placements of the {} pipeline on {} (predicted)", pipeline.id,
                       several() ? fmt::format("{} machines", report_.machines.size())
                                 : report_.machines.front().id);
  }

  /// The accelerators that a placement needs: what has to be bought.
  std::string parts_in_use(const MachineResult& result,
                           const partition::TaskPlacement& placement) const {
    const profile::Machine& machine = report_.machine(result);
    std::string names;
    for (std::uint32_t d = 0; d < machine.devices.size(); ++d) {
      if (machine.devices[d].is_host_cpu) continue;
      bool used = false;
      for (std::uint32_t t = 0; t < placement.size(); ++t) {
        const partition::Place& place = report_.evaluator(result).places(t)[placement[t]];
        used = used || (place.is_device && place.index == d);
      }
      if (used) names += (names.empty() ? "" : " + ") + machine.devices[d].name;
    }
    return names.empty() ? "CPUs only" : names;
  }

  std::size_t group(const std::string& name, const Score& score) {
    const auto found = std::find_if(groups_.begin(), groups_.end(),
                                    [&](const Group& g) { return g.name == name; });
    const auto index = static_cast<std::size_t>(found - groups_.begin());
    if (found == groups_.end()) groups_.push_back({name, score.price_usd, score.price_usd, 0});
    Group& g = groups_[index];
    g.least_usd = std::min(g.least_usd, score.price_usd);
    g.most_usd = std::max(g.most_usd, score.price_usd);
    return index;
  }

  /// Who leaves out work is quick and saves energy: beside who does not, that says nothing.
  bool shown(const Score& score) const {
    return score.dropped == 0 || report_.winner().best->score.dropped > 0;
  }

  void collect(const MachineResult& result) {
    for (const partition::Scored& point : result.front) {
      const std::string name = several() ? result.machine : parts_in_use(result, point.placement);
      const std::size_t in = group(name, point.score);
      if (!shown(point.score)) {
        ++left_out_;
        continue;
      }
      front_.push_back({point.score, in});
      ++groups_[in].shown;
    }
    for (const Score& score : result.dominated) {
      if (shown(score)) {
        dominated_.push_back({score, groups_.empty() ? 0 : groups_.size() - 1});
      } else {
        ++left_out_;
      }
    }
  }

  void name_groups() {
    for (Group& g : groups_) {
      g.name += g.least_usd == g.most_usd
                    ? fmt::format(", {:.0f} USD", g.least_usd)
                    : fmt::format(", {:.0f} to {:.0f} USD", g.least_usd, g.most_usd);
    }
  }

  std::pair<plot::Axis, plot::Axis> axes() const {
    Score least = report_.winner().best->score, most = least;
    for (const auto* points : {&front_, &dominated_}) {
      for (const Plotted& p : *points) {
        least.p99_ns = std::min(least.p99_ns, p.score.p99_ns);
        most.p99_ns = std::max(most.p99_ns, p.score.p99_ns);
        least.energy_j = std::min(least.energy_j, p.score.energy_j);
        most.energy_j = std::max(most.energy_j, p.score.energy_j);
      }
    }
    return {plot::Axis(least.p99_ns / 1e6, most.p99_ns / 1e6, kLeft, kRight),
            plot::Axis(least.energy_j, most.energy_j, kBottom, kTop)};
  }

  static Point at(const plot::Axis& x, const plot::Axis& y, const Score& score) {
    return {x(score.p99_ns / 1e6), y(score.energy_j)};
  }

  void mark(const plot::Axis& x, const plot::Axis& y, const Score& score, plot::Rgb colour,
            double radius) {
    drawing_.add(plot::Mark{.at = at(x, y, score), .radius = radius, .fill = colour});
  }

  void frame(const plot::Axis& x, const plot::Axis& y) {
    for (const plot::Tick& tick : x.ticks(8)) {
      const double px = x(tick.value);
      drawing_.add(plot::Line{{{px, kTop}, {px, kBottom}}, plot::kGrid});
      drawing_.add(plot::Text{{px, kBottom + 22}, tick.label, 14, Anchor::middle});
    }
    for (const plot::Tick& tick : y.ticks(6)) {
      const double py = y(tick.value);
      drawing_.add(plot::Line{{{kLeft, py}, {kRight, py}}, plot::kGrid});
      drawing_.add(plot::Text{{kLeft - 10, py + 5}, tick.label, 14, Anchor::end});
    }
    drawing_.add(plot::Line{{{kLeft, kTop}, {kLeft, kBottom}, {kRight, kBottom}}, plot::kInk, 1.5});
    drawing_.add(plot::Text{{kLeft, 40}, title(), 20, Anchor::start, plot::kInk, true});
    const auto scale = [](const plot::Axis& axis) {
      return axis.logarithmic() ? ", logarithmic" : "";
    };
    drawing_.add(plot::Text{{(kLeft + kRight) / 2, kBottom + 52},
                            fmt::format("end-to-end latency p99, ms{}", scale(x)),
                            16,
                            Anchor::middle});
    drawing_.add(plot::Text{{30, (kTop + kBottom) / 2},
                            fmt::format("energy per frame, J{}", scale(y)),
                            16,
                            Anchor::middle,
                            plot::kInk,
                            false,
                            true});
  }

  /// The front in the two figures shown; the other points of the front win in others.
  void staircase(const plot::Axis& x, const plot::Axis& y) {
    std::vector<Point> points;
    for (const Plotted& p : front_) {
      if (p.score.dropped == 0) points.push_back(at(x, y, p.score));
    }
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.x != b.x ? a.x < b.x : a.y > b.y; });
    plot::Line line{{}, plot::kGrey, 1.5};
    for (const Point& p : points) {
      if (!line.points.empty() && p.y <= line.points.back().y) continue;
      if (!line.points.empty()) line.points.push_back({p.x, line.points.back().y});
      line.points.push_back(p);
    }
    if (line.points.size() > 1) drawing_.add(line);
  }

  void best(const plot::Axis& x, const plot::Axis& y) {
    const Score& score = report_.winner().best->score;
    const Point p = at(x, y, score);
    drawing_.add(plot::Mark{.at = p,
                            .radius = 13,
                            .fill = plot::kInk,
                            .border = 1.5,
                            .border_colour = plot::kWhite,
                            .star = true});
  }

  void legend() {
    constexpr double kX = kRight + 34, kText = kX + 20;
    double y = kTop + 8;
    const auto entry = [&](const plot::Mark& sample, const std::string& text) {
      plot::Mark mark = sample;
      mark.at = {kX, y - 5};
      drawing_.add(mark);
      drawing_.add(plot::Text{{kText, y}, text, 14});
      y += 24;
    };
    const auto heading = [&](const std::string& text) {
      drawing_.add(plot::Text{{kX - 8, y}, text, 14, Anchor::start, plot::kInk, true});
      y += 26;
    };
    heading(several() ? "Machine" : "Accelerators in use");
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (groups_[g].shown == 0) continue;
      entry({.radius = 5.5, .fill = plot::series(g)}, groups_[g].name);
    }
    y += 14;
    heading("Placements");
    std::string objective(to_string(report_.exploration.options.objective));
    const Score& best = report_.winner().best->score;
    entry({.radius = 9, .fill = plot::kInk, .star = true}, fmt::format("best by {}:", objective));
    drawing_.add(plot::Text{{kText, y},
                            fmt::format("{:.1f} ms, {:.2f} J", best.p99_ns / 1e6, best.energy_j),
                            14,
                            Anchor::start,
                            plot::kInk,
                            true});
    y += 24;
    if (several()) {
      drawing_.add(plot::Text{{kText, y}, "on " + report_.winner().machine, 14});
      y += 24;
    }
    const auto complete = std::count_if(front_.begin(), front_.end(),
                                        [](const Plotted& p) { return p.score.dropped == 0; });
    entry({.radius = 5.5, .fill = plot::kGrey},
          fmt::format("not dominated{} ({})", several() ? " there" : "", complete));
    const auto dropping = front_.size() - static_cast<std::size_t>(complete);
    if (dropping > 0) {
      entry({.radius = 5.5, .fill = plot::kWhite, .border = 2, .border_colour = plot::kGrey},
            fmt::format("the same, but drops frames ({})", dropping));
    }
    entry({.radius = 2.5, .fill = plot::kLight},
          fmt::format("dominated, pale ({})", dominated_.size()));
    drawing_.add(plot::Line{{{kX - 8, y - 5}, {kX + 8, y - 5}}, plot::kGrey, 1.5});
    drawing_.add(plot::Text{{kText, y}, "front of these two figures", 14});
    y += 38;
    notes({kX - 8, y});
  }

  void notes(Point at) {
    std::vector<std::string> lines{"Domination also counts median", "latency, throughput, price,",
                                   "FPGA area and frames dropped."};
    if (left_out_ > 0) {
      std::string none;
      for (const Group& g : groups_) {
        if (g.shown == 0) none += (none.empty() ? "" : ", ") + g.name.substr(0, g.name.find(','));
      }
      lines.push_back(
          fmt::format("Not shown: {} that drop frames{}", left_out_, none.empty() ? "." : ""));
      if (!none.empty()) lines.push_back("(all of " + none + ").");
    }
    for (const std::string& line : lines) {
      drawing_.add(plot::Text{at, line, 13, Anchor::start, plot::kGrey});
      at.y += 19;
    }
  }

  const ExploreReport& report_;
  plot::Drawing drawing_;
  std::vector<Group> groups_;
  std::vector<Plotted> front_, dominated_;
  std::size_t left_out_ = 0;
};

}  // namespace

void write_pareto_plot(const std::string& folder, const ExploreReport& report) {
  ParetoPlot(report).draw().write(folder, "pareto");
}

}  // namespace partita::app
