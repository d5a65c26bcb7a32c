// schedule.svg, schedule.png: who does what when, for some frames of the best placement.
#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "host/app/explore.h"
#include "host/app/plot_axis.h"

namespace partita::app {
namespace {

using plot::Anchor;
using timeline::Ns;

constexpr double kWidth = 1400, kLeft = 190, kRight = 1370, kTop = 122, kLane = 26, kBar = 18;

/// What an engine did for a task's frame, without the gaps that nobody could see.
struct Bar {
  std::uint32_t engine = 0;
  timeline::NameId task = 0;
  std::int64_t frame = 0;
  double from = 0, to = 0;  ///< pixels
};

/// Neighbouring frames that show every rhythm of the pipeline, from the middle of the simulation.
struct Window {
  std::size_t first = 0, frames = 0;
  Ns from = 0, to = 0;
};

Window window_of(const partition::Pipeline& pipeline, std::size_t frames) {
  constexpr std::size_t kShown = 3;
  std::size_t rhythm = 1;
  for (const partition::PipelineTask& task : pipeline.tasks) {
    rhythm = std::lcm(rhythm, std::size_t{task.every});
  }
  Window window;
  window.frames = std::min(kShown, frames);
  window.first = (frames - window.frames) / 2 / rhythm * rhythm;
  window.from = window.first * pipeline.period_ns;
  window.to = window.from + window.frames * pipeline.period_ns;
  return window;
}

class SchedulePlot {
 public:
  explicit SchedulePlot(const ExploreReport& report)
      : report_(report),
        record_(report.best->record),
        schedule_(report.best->schedule),
        window_(window_of(report.pipeline, report.scheduled_frames)) {
    extend_to_last_end();
    choose_lanes();
  }

  plot::Drawing draw() {
    const double bottom = kTop + kLane * static_cast<double>(lanes_.size());
    plot::Drawing drawing(kWidth, bottom + 70, title());
    const plot::Axis time(0, milliseconds(window_.to), kLeft, kRight);
    header(drawing);
    frame(drawing, bottom);
    for (const Bar& bar : bars()) draw_bar(drawing, bar);
    return drawing;
  }

 private:
  std::string title() const {
    return fmt::format("{} on {}: {} frames of the best placement (predicted)", report_.pipeline.id,
                       report_.winner().machine, window_.frames);
  }

  double milliseconds(Ns time) const {
    return (static_cast<double>(time) - static_cast<double>(window_.from)) / 1e6;
  }
  double x(Ns time) const {
    const double share = (static_cast<double>(time) - static_cast<double>(window_.from)) /
                         static_cast<double>(window_.to - window_.from);
    return kLeft + std::clamp(share, 0.0, 1.0) * (kRight - kLeft);
  }

  /// The last frame shown is shown to its end, unless that is far.
  void extend_to_last_end() {
    const auto last = static_cast<std::int64_t>(window_.first + window_.frames - 1);
    Ns end = window_.to;
    for (const timeline::Occupation& part : schedule_.occupations) {
      if (record_.commands[part.node].frame == last) end = std::max(end, part.end);
    }
    window_.to = std::min(end, window_.to + 2 * report_.pipeline.period_ns);
  }

  bool visible(const timeline::Occupation& part) const {
    return part.end > window_.from && part.start < window_.to;
  }

  /// Engines that do something in the window, in the schedule's order.
  void choose_lanes() {
    std::vector<bool> used(schedule_.engines.size(), false);
    for (const timeline::Occupation& part : schedule_.occupations) {
      if (visible(part)) used[part.engine] = true;
    }
    lane_.resize(used.size());
    for (std::uint32_t e = 0; e < used.size(); ++e) {
      lane_[e] = lanes_.size();
      if (used[e]) lanes_.push_back(e);
    }
  }

  std::vector<Bar> bars() const {
    constexpr double kInvisible = 0.8;  // px
    std::vector<Bar> bars;
    std::vector<std::size_t> last(schedule_.engines.size(), SIZE_MAX);
    for (const timeline::Occupation& part : schedule_.occupations) {
      if (!visible(part)) continue;
      const timeline::RecordedCommand& command = record_.commands[part.node];
      const Bar bar{part.engine, command.task, command.frame, x(part.start), x(part.end)};
      std::size_t& before = last[part.engine];
      if (before != SIZE_MAX && bars[before].task == bar.task && bars[before].frame == bar.frame &&
          bar.from - bars[before].to < kInvisible) {
        bars[before].to = std::max(bars[before].to, bar.to);
        continue;
      }
      before = bars.size();
      bars.push_back(bar);
    }
    return bars;
  }

  std::size_t task_number(const std::string& name) const {
    const auto& tasks = report_.pipeline.tasks;
    return static_cast<std::size_t>(
        std::find_if(tasks.begin(), tasks.end(),
                     [&](const partition::PipelineTask& task) { return task.name == name; }) -
        tasks.begin());
  }

  /// Black is kept for text: the eighth task is grey.
  static plot::Rgb colour(std::size_t task) { return task < 7 ? plot::series(task) : plot::kGrey; }

  void draw_bar(plot::Drawing& drawing, const Bar& bar) const {
    // What takes next to no time is still seen.
    constexpr double kLeast = 1;
    const double width = std::max(kLeast, bar.to - bar.from);
    const double top = kTop + kLane * static_cast<double>(lane_[bar.engine]) + (kLane - kBar) / 2;
    const plot::Rgb fill = colour(task_number(record_.names[bar.task]));
    drawing.add(plot::Box{.from = {bar.from, top}, .width = width, .height = kBar, .fill = fill});
    const std::string label = std::to_string(bar.frame);
    if (width < plot::text_width(label, 12) + 6) return;
    const bool dark = 0.299 * fill.r + 0.587 * fill.g + 0.114 * fill.b < 140;
    drawing.add(plot::Text{{bar.from + width / 2, top + kBar - 5},
                           label,
                           12,
                           Anchor::middle,
                           dark ? plot::kWhite : plot::kInk});
  }

  void header(plot::Drawing& drawing) const {
    drawing.add(plot::Text{{20, 36}, title(), 20, Anchor::start, plot::kInk, true});
    double at = 20;
    for (std::size_t t = 0; t < report_.pipeline.tasks.size(); ++t) {
      const std::string name =
          report_.pipeline.tasks[t].name + (report_.workload.tasks[t].outline ? " *" : "");
      drawing.add(plot::Box{.from = {at, 54}, .width = 14, .height = 14, .fill = colour(t)});
      drawing.add(plot::Text{{at + 20, 66}, name, 14});
      at += 44 + plot::text_width(name, 14);
    }
    const bool outline = std::any_of(report_.workload.tasks.begin(), report_.workload.tasks.end(),
                                     [](const partition::TaskWork& task) { return task.outline; });
    if (outline) {
      drawing.add(plot::Text{{at + 10, 66}, "* by its Work alone", 13, Anchor::start, plot::kGrey});
    }
  }

  void frame(plot::Drawing& drawing, double bottom) const {
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      const double top = kTop + kLane * static_cast<double>(i);
      if (i % 2 == 0) {
        drawing.add(plot::Box{.from = {kLeft, top},
                              .width = kRight - kLeft,
                              .height = kLane,
                              .fill = {246, 246, 246}});
      }
      drawing.add(
          plot::Text{{kLeft - 10, top + 18}, schedule_.engines[lanes_[i]].name, 13, Anchor::end});
    }
    const double step = plot::nice_step(milliseconds(window_.to), 16);
    for (double k = 0; k * step <= milliseconds(window_.to); ++k) {
      const double px = x(window_.from + static_cast<Ns>(k * step * 1e6));
      drawing.add(plot::Line{{{px, kTop}, {px, bottom + 5}}, plot::kLight});
      drawing.add(plot::Text{{px, bottom + 22}, fmt::format("{:g}", k * step), 13, Anchor::middle});
    }
    const std::size_t frames = report_.scheduled_frames;
    for (std::size_t k = window_.first; k < frames; ++k) {
      const Ns trigger = k * report_.pipeline.period_ns;
      if (trigger >= window_.to) break;
      const double px = x(trigger);
      drawing.add(plot::Line{{{px, kTop - 22}, {px, bottom}}, plot::kInk, 1.25, true});
      drawing.add(plot::Text{
          {px + 5, kTop - 8}, fmt::format("frame {}", k), 13, Anchor::start, plot::kInk, true});
    }
    drawing.add(plot::Line{{{kLeft, bottom}, {kRight, bottom}}, plot::kInk, 1.5});
    drawing.add(plot::Text{{(kLeft + kRight) / 2, bottom + 50},
                           fmt::format("ms since the trigger of frame {}", window_.first),
                           15,
                           Anchor::middle});
  }

  const ExploreReport& report_;
  const timeline::Record& record_;
  const timeline::Schedule& schedule_;
  Window window_;
  std::vector<std::uint32_t> lanes_;  ///< engines
  std::vector<std::size_t> lane_;     ///< by engine
};

}  // namespace

void write_schedule_plot(const std::string& folder, const ExploreReport& report) {
  SchedulePlot(report).draw().write(folder, "schedule");
}

}  // namespace partita::app
