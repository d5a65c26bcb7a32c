// What explore says to people: the question, the ranking of several machines, the best placement
// and why, what else there is, what cannot be.
#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "host/app/explore.h"

namespace partita::app {
namespace {

using partition::Detailed;
using partition::MachineResult;
using partition::Objective;

/// Rows of a table that a person still reads; the rest is in the files.
constexpr std::size_t kFrontRows = 12, kRefusalRows = 6, kTieRows = 4;

std::string ms(double ns) {
  return fmt::format("{:.2f}", ns / 1e6);
}

/// 2495 as "2,495".
std::string thousands(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, 1, ',');
  return digits;
}

std::string usd(double price) {
  return thousands(static_cast<std::uint64_t>(price + 0.5));
}

/// Broken between words where it gets wider than a terminal, what follows under what came first.
std::string wrapped(const std::string& lead, const std::string& text) {
  constexpr std::size_t kColumns = 100;
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    if (word.front() == '%' && !words.empty()) {
      words.back() += " " + word;  // "22 %" stays together
    } else {
      words.push_back(word);
    }
  }
  std::string result, line = lead;
  for (const std::string& word : words) {
    if (line.size() > lead.size() && line.size() + 1 + word.size() > kColumns) {
      result += line + "\n";
      line.assign(lead.size(), ' ');
    }
    if (line.size() > lead.size()) line += ' ';
    line += word;
  }
  return result + line + "\n";
}

class ExplorationText {
 public:
  ExplorationText(const ExploreReport& report, const Console& console)
      : report_(report),
        console_(console),
        objective_(report.exploration.options.objective),
        winner_(report.winner()) {}

  std::string all() const {
    std::string text = question();
    if (report_.exploration.machines.size() > 1) text += ranking();
    text += best() + why() + ties() + front() + refusals() + files();
    return text;
  }

 private:
  std::string title(const std::string& text) const {
    return fmt::format("\n{}\n", console_.paint(Colour::bold, text));
  }

  std::string question() const {
    const partition::Pipeline& pipeline = report_.pipeline;
    std::string machines;
    for (const profile::Machine& machine : report_.machines) {
      machines += (machines.empty() ? "" : ", ") + machine.id;
    }
    const partition::SearchOptions& search = report_.exploration.options;
    std::string text = fmt::format(
        "pipeline   {}: {} tasks, {}x{} at {:g} Hz, {} frames simulated\n"
        "machine    {}\n"
        "work       {}\n"
        "objective  least {}\n",
        pipeline.id, pipeline.tasks.size(), pipeline.width, pipeline.height,
        1e9 / static_cast<double>(pipeline.period_ns), report_.options.frames, machines,
        report_.workload.origin, to_string(objective_));
    if (objective_ == Objective::throughput) text.replace(text.rfind("least"), 5, "most");
    if (!search.pins.empty()) {
      text += "pins       ";
      for (const partition::Pin& pin : search.pins) text += pin.to_string() + " ";
      text.back() = '\n';
    }
    if (const std::string limits = search.limits.to_string(); !limits.empty()) {
      text += "limits     " + limits + "\n";
    }
    if (report_.partial()) {
      text += console_.paint(Colour::yellow, "partial") +
              "    the search was stopped; what follows is what it had found\n";
    }
    return text;
  }

  std::string ranking() const {
    std::string text = title("machines, each with its best placement (predicted)");
    Table table({"", "machine", "p99 ms", "p50 ms", "J/frame", "W", "Hz", "USD", "dropped",
                 "against the first"});
    std::size_t rank = 0;
    for (const partition::Ranked& ranked : report_.exploration.ranking) {
      const MachineResult& result = report_.exploration.machines[ranked.machine];
      const partition::Score& s = result.best->score;
      table.add({std::to_string(++rank), result.machine, ms(s.p99_ns), ms(s.p50_ns),
                 fmt::format("{:.2f}", s.energy_j), fmt::format("{:.1f}", s.power_w),
                 fmt::format("{:.1f}", s.throughput_hz()), usd(s.price_usd),
                 fmt::format("{:.1f} %", 100 * s.dropped), against_first(ranked)});
    }
    text += table.to_string(console_.colour());
    for (const MachineResult& result : report_.exploration.machines) {
      if (!result.best) text += wrapped("no answer: ", result.unreachable);
    }
    return text;
  }

  /// How sure the distance to the first of the ranking is.
  std::string against_first(const partition::Ranked& ranked) const {
    if (ranked.machine == report_.exploration.ranking.front().machine) return "";
    if (ranked.tie) return "tie";
    const partition::Comparison& c = ranked.behind;
    if (c.dropped != 0) return "drops more";
    return fmt::format("behind by at least {}",
                       show(c.by, std::min(std::abs(c.least), std::abs(c.most))));
  }

  std::string method() const {
    const MachineResult& r = winner_;
    if (r.stopped) {
      return fmt::format("{} of {} placements looked at before the search was stopped",
                         thousands(r.evaluated + r.infeasible), thousands(r.placements));
    }
    std::string text =
        r.method == partition::Method::enumeration
            ? fmt::format("all {} placements looked at, the {} feasible ones simulated",
                          thousands(r.placements), thousands(r.evaluated))
            : fmt::format("{} of {} placements simulated ({})", thousands(r.evaluated),
                          thousands(r.placements), to_string(r.method));
    if (r.beyond_limits > 0)
      text += fmt::format(", {} beyond the limits", thousands(r.beyond_limits));
    if (r.optimal) return text + ": the optimum";
    return text + fmt::format("; none can have {} than {}: at most {:.1f} % from the optimum",
                              objective_ == Objective::throughput ? "more" : "less",
                              show(objective_, r.bound), 100 * r.gap);
  }

  std::string best() const {
    const Detailed& best = *winner_.best;
    std::string text = title(fmt::format("best placement on {} (predicted)", winner_.machine));
    text += wrapped("", method()) + "\n";
    text += task_table(best);
    const auto& works = report_.workload.tasks;
    if (std::any_of(works.begin(), works.end(), [](const auto& task) { return task.outline; })) {
      text += "* takes part by its Work alone, counted from the algorithm and not from kernels\n";
    }
    text += "\n";
    return text + figures(best);
  }

  std::string task_table(const Detailed& best) const {
    const auto or_dash = [](std::size_t n) { return n > 0 ? std::to_string(n) : "-"; };
    Table table({"task", "runs on", "alone ms", "as it ran", "contention", "late", "dropped"});
    for (std::uint32_t t = 0; t < best.placement.size(); ++t) {
      const partition::TaskFigures& f = best.figures.tasks[t];
      const char* mark = report_.workload.tasks[t].outline ? " *" : "";
      const double contention = f.duration.mean - f.alone_ns;
      const bool visible = contention > 5e3;  // in two decimals of a millisecond
      table.add({report_.pipeline.tasks[t].name + mark, report_.place(winner_, best.placement, t),
                 ms(f.alone_ns), ms(f.duration.mean),
                 visible ? fmt::format("+{}", ms(contention)) : "-", or_dash(f.late),
                 or_dash(f.dropped)});
    }
    return table.to_string(console_.colour());
  }

  std::string figures(const Detailed& best) const {
    const partition::Score& s = best.score;
    const partition::Figures& f = best.figures;
    const partition::Vehicle& vehicle = report_.options.vehicle;
    std::string text = fmt::format(
        "latency     p50 {} ms, p99 {} ms, end to end; perception {} and {} ms\n"
        "energy      {:.2f} J a frame, {:.1f} W\n"
        "throughput  {:.1f} Hz; {} of {} frames late, {} not finished\n"
        "price       {} USD\n",
        ms(s.p50_ns), ms(s.p99_ns), ms(static_cast<double>(f.perception.p50)),
        ms(static_cast<double>(f.perception.p99)), s.energy_j, s.power_w, s.throughput_hz(), f.late,
        report_.options.frames, f.dropped, usd(s.price_usd));
    for (const partition::FpgaArea& area : best.areas) text += area_line(area);
    return text + fmt::format(
                      "vehicle     {:.2f} m further to a stop at {:g} m/s; {:.1f} h of "
                      "driving on {:g} Wh with {:g} W for all else\n",
                      best.added_stopping_m, vehicle.speed_mps, best.driving_hours,
                      vehicle.battery_wh, vehicle.base_power_w);
  }

  static std::string area_line(const partition::FpgaArea& area) {
    std::string parts;
    const auto add = [&parts](const char* name, std::uint64_t used, std::uint64_t available) {
      if (used == 0) return;
      parts += fmt::format(
          "{}{} {} of {}{}", parts.empty() ? "" : ", ", name, thousands(used), thousands(available),
          available > 0 ? fmt::format(" ({:.0f} %)", 100 * static_cast<double>(used) /
                                                         static_cast<double>(available))
                        : "");
    };
    add("LUT", area.used.lut, area.available.lut);
    add("FF", area.used.ff, area.available.ff);
    add("BRAM36", area.used.bram36, area.available.bram36);
    add("URAM", area.used.uram, area.available.uram);
    add("DSP", area.used.dsp, area.available.dsp);
    return wrapped("area        ", fmt::format("{}: {}", area.device, parts));
  }

  std::string why() const {
    std::string text = title("why");
    for (const std::string& line : winner_.explanation.lines) text += wrapped("- ", line);
    return text;
  }

  std::string ties() const {
    if (winner_.ties.empty()) return "";
    const std::size_t count = winner_.ties.size();
    const std::size_t compared = report_.exploration.options.tie_candidates;
    std::string text = title(
        winner_.all_ties
            ? fmt::format("within the uncertainty of the predictions, as good: {} others", count)
            : fmt::format("within the uncertainty of the predictions, as good: {} of the next {}",
                          count, compared));
    for (std::size_t i = 0; i < std::min(kTieRows, winner_.ties.size()); ++i) {
      const partition::Rival& tie = winner_.ties[i];
      std::string changes;
      for (const std::string& change : tie.changes) {
        changes += (changes.empty() ? "" : ", ") + change;
      }
      text += wrapped("- ", fmt::format("p99 {} ms, {:.2f} J, {} USD: {}", ms(tie.score.p99_ns),
                                        tie.score.energy_j, usd(tie.score.price_usd), changes));
    }
    if (winner_.ties.size() > kTieRows) {
      text += fmt::format("- {} more, in {}\n", winner_.ties.size() - kTieRows, kExploreFile);
    }
    return text;
  }

  /// Those that a table has room for, of those that drop as little as any: evenly spread over the
  /// front, which begins with them and is ordered by latency.
  std::vector<std::size_t> chosen() const {
    const auto& front = winner_.front;
    const auto size = static_cast<std::size_t>(
        std::count_if(front.begin(), front.end(), [&](const partition::Scored& point) {
          return point.score.dropped == front.front().score.dropped;
        }));
    std::vector<std::size_t> rows;
    const std::size_t count = std::min(size, kFrontRows);
    for (std::size_t i = 0; i < count; ++i) {
      rows.push_back(count == size ? i : i * (size - 1) / (count - 1));
    }
    return rows;
  }

  /// Where a placement differs from the best one; the whole of it would not fit a line.
  std::string moved(const partition::TaskPlacement& placement) const {
    std::string text;
    for (std::uint32_t t = 0; t < placement.size(); ++t) {
      if (placement[t] == winner_.best->placement[t]) continue;
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", report_.pipeline.tasks[t].name,
                          report_.place(winner_, placement, t));
    }
    return text.empty() ? "(the best)" : text;
  }

  std::string front() const {
    const std::vector<std::size_t> rows = chosen();
    const std::size_t size = winner_.front.size();
    std::string text = title(fmt::format("Pareto front of {} (predicted)", winner_.machine));
    text += fmt::format(
        "{} that no other {} beats{}\n",
        size == 1 ? "one placement" : fmt::format("{} placements", size),
        winner_.exact_front ? "one" : "one looked at",
        rows.size() < size
            ? fmt::format("; {} of those that drop least here, all in explore.csv", rows.size())
            : "");
    Table table({"p50 ms", "p99 ms", "J/frame", "W", "Hz", "USD", "area", "dropped",
                 "moved from the best"});
    for (const std::size_t i : rows) {
      const partition::Scored& point = winner_.front[i];
      const partition::Score& s = point.score;
      table.add({ms(s.p50_ns), ms(s.p99_ns), fmt::format("{:.2f}", s.energy_j),
                 fmt::format("{:.1f}", s.power_w), fmt::format("{:.1f}", s.throughput_hz()),
                 usd(s.price_usd), fmt::format("{:.0f} %", 100 * s.area),
                 fmt::format("{:.1f} %", 100 * s.dropped), moved(point.placement)});
    }
    return text + table.to_string(console_.colour());
  }

  std::string refusals() const {
    if (winner_.infeasible == 0) return "";
    std::string text =
        title(fmt::format("not feasible: {} placements", thousands(winner_.infeasible)));
    std::uint64_t left = 0;
    for (std::size_t i = 0; i < winner_.refusals.size(); ++i) {
      const partition::Refusal& refusal = winner_.refusals[i];
      if (i < kRefusalRows) {
        text += wrapped("- ", fmt::format("{}: {}", thousands(refusal.count), refusal.reason));
      } else {
        left += refusal.count;
      }
    }
    if (left > 0) {
      text += fmt::format("- {}: {} other reasons, in {}\n", thousands(left),
                          winner_.refusals.size() - kRefusalRows, kExploreFile);
    }
    return text;
  }

  std::string files() const {
    std::string text = fmt::format("\nwritten to {}:", report_.options.out);
    for (const std::string& file : report_.files) text += " " + file;
    return text + "\n";
  }

  const ExploreReport& report_;
  const Console& console_;
  Objective objective_;
  const MachineResult& winner_;
};

}  // namespace

std::string to_text(const ExploreReport& report, const Console& console) {
  return ExplorationText(report, console).all();
}

}  // namespace partita::app
