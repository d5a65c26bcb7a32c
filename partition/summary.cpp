#include "partition/summary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace partita::partition {
namespace {

using timeline::kNone;
using timeline::Record;
using timeline::RecordedCommand;
using timeline::Schedule;
using timeline::ScheduledCommand;

/// First START and last END of a set of commands.
struct Span {
  Ns first = std::numeric_limits<Ns>::max();
  Ns last = 0;
  void add(const timeline::Times& times) {
    first = std::min(first, times.start);
    last = std::max(last, times.end);
  }
};

/// Threads that drive a branch: bound ones, by rank.
std::vector<std::uint32_t> branch_threads(const Record& record) {
  std::vector<std::uint32_t> threads;
  for (std::uint32_t i = 0; i < record.threads.size(); ++i) {
    if (record.threads[i].rank != kNone && record.threads[i].after == kNone) threads.push_back(i);
  }
  std::stable_sort(threads.begin(), threads.end(), [&](std::uint32_t a, std::uint32_t b) {
    return record.threads[a].rank < record.threads[b].rank;
  });
  return threads;
}

using FrameSpans = std::map<std::int64_t, Span>;

/// Per frame, what a thread did from first START to last END; with `task` only that task's part.
FrameSpans frame_spans(const Record& record, const Schedule& schedule, std::uint32_t thread,
                       timeline::NameId task = kNone) {
  FrameSpans spans;
  for (const ScheduledCommand& scheduled : schedule.commands) {
    const RecordedCommand& command = record.commands[scheduled.command];
    if (command.thread != thread || command.frame < 0 || !scheduled.resolved) continue;
    if (task != kNone && command.task != task) continue;
    spans[command.frame].add(scheduled.times);
  }
  return spans;
}

std::vector<BranchFrame> branch_frames(const FrameSpans& spans,
                                       const std::vector<Arrival>& arrivals) {
  std::vector<BranchFrame> frames;
  for (const Arrival& arrival : arrivals) {
    const auto span = spans.find(arrival.frame);
    if (span == spans.end()) continue;
    frames.push_back({arrival.frame, arrival.time, std::max(span->second.last, arrival.time)});
  }
  return frames;
}

Distribution latencies(const std::vector<BranchFrame>& frames) {
  std::vector<Ns> values;
  for (const BranchFrame& frame : frames) values.push_back(frame.latency());
  return distribution(std::move(values));
}

std::optional<double> throughput(const std::vector<BranchFrame>& frames) {
  if (frames.size() < 2) return std::nullopt;
  const Ns span = frames.back().finish - frames.front().finish;
  return static_cast<double>(frames.size() - 1) * 1e9 / static_cast<double>(std::max<Ns>(span, 1));
}

/// std::nullopt < any rate: a branch without a rate leaves the pipeline without one.
std::optional<double> slowest_rate(const std::vector<BranchSummary>& branches) {
  const auto slower = std::min_element(branches.begin(), branches.end(),
                                       [](const BranchSummary& a, const BranchSummary& b) {
                                         return a.throughput_hz < b.throughput_hz;
                                       });
  return slower == branches.end() ? std::nullopt : slower->throughput_hz;
}

std::size_t count_processed(const std::vector<BranchSummary>& branches) {
  std::set<std::int64_t> frames;
  for (const BranchSummary& branch : branches) {
    for (const BranchFrame& frame : branch.frames) frames.insert(frame.frame);
  }
  return frames.size();
}

double mean_span(const FrameSpans& spans) {
  double sum = 0;
  for (const auto& [frame, span] : spans) sum += static_cast<double>(span.last - span.first);
  return spans.empty() ? 0 : sum / static_cast<double>(spans.size());
}

std::vector<timeline::NameId> tasks_of(const Record& record, std::uint32_t thread) {
  std::vector<timeline::NameId> tasks;
  for (const RecordedCommand& command : record.commands) {
    const bool known = std::find(tasks.begin(), tasks.end(), command.task) != tasks.end();
    if (command.thread == thread && command.frame >= 0 && !known) tasks.push_back(command.task);
  }
  return tasks;
}

void add_branch(const Record& record, const Schedule& schedule, std::uint32_t thread,
                const std::vector<Arrival>& arrivals, Summary& summary) {
  const Record alone_record = only_thread(record, thread);
  const Schedule alone = timeline::replay(alone_record);
  BranchSummary branch;
  branch.name = record.threads[thread].name;
  branch.frames = branch_frames(frame_spans(record, schedule, thread), arrivals);
  branch.latency = latencies(branch.frames);
  branch.throughput_hz = throughput(branch.frames);
  branch.alone = latencies(branch_frames(frame_spans(alone_record, alone, thread), arrivals));
  for (const timeline::NameId task : tasks_of(record, thread)) {
    summary.tasks.push_back({branch.name, record.names[task],
                             mean_span(frame_spans(record, schedule, thread, task)),
                             mean_span(frame_spans(alone_record, alone, thread, task))});
  }
  summary.branches.push_back(std::move(branch));
}

/// The slower branch decides when a frame is perceived; frames that a branch dropped are not.
std::vector<BranchFrame> slowest(const std::vector<BranchSummary>& branches) {
  std::map<std::int64_t, std::pair<std::size_t, BranchFrame>> joined;
  for (const BranchSummary& branch : branches) {
    for (const BranchFrame& frame : branch.frames) {
      auto& [count, slower] = joined[frame.frame];
      if (count++ == 0 || frame.finish > slower.finish) slower = frame;
    }
  }
  std::vector<BranchFrame> frames;
  for (const auto& [number, entry] : joined) {
    if (entry.first == branches.size()) frames.push_back(entry.second);
  }
  return frames;
}

std::size_t count_late(const std::vector<BranchFrame>& frames, const std::vector<Arrival>& arrivals,
                       Ns period) {
  std::map<std::int64_t, Ns> deadline;
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    deadline[arrivals[i].frame] =
        i + 1 < arrivals.size() ? arrivals[i + 1].time : arrivals[i].time + period;
  }
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(),
                    [&](const BranchFrame& f) { return f.finish > deadline.at(f.frame); }));
}

void add_engines(const Schedule& schedule, Summary& summary) {
  const std::vector<double> shares = schedule.utilisation();
  std::vector<Ns> busy(schedule.engines.size(), 0);
  for (const timeline::Occupation& part : schedule.occupations) {
    busy[part.engine] += part.end - part.start;
  }
  for (std::size_t i = 0; i < schedule.engines.size(); ++i) {
    summary.engines.push_back({schedule.engines[i].name, busy[i], shares[i]});
  }
}

}  // namespace

Distribution distribution(std::vector<Ns> values) {
  Distribution d;
  if (values.empty()) return d;
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (const Ns value : values) sum += static_cast<double>(value);
  const auto rank = [&](double share) {
    const double position = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<std::size_t>(std::max(position, 1.0)) - 1];
  };
  d.mean = sum / static_cast<double>(values.size());
  d.p50 = rank(0.50);
  d.p99 = rank(0.99);
  d.max = values.back();
  return d;
}

Record only_thread(const Record& record, std::uint32_t thread) {
  Record alone = record;
  // A callback belongs to the thread that enqueued what it is called for.
  const auto belongs = [&](std::uint32_t index) {
    while (record.threads[index].after != kNone) {
      index = record.commands[record.threads[index].after].thread;
    }
    return index == thread;
  };
  for (std::uint32_t i = 0; i < alone.threads.size(); ++i) {
    if (!belongs(i)) alone.threads[i].actions.clear();
  }
  return alone;
}

Summary summarise(const Record& record, const Schedule& schedule, const profile::Machine& machine,
                  const std::vector<Arrival>& arrivals, Ns period) {
  Summary summary;
  for (const std::uint32_t thread : branch_threads(record)) {
    add_branch(record, schedule, thread, arrivals, summary);
  }
  summary.perception = slowest(summary.branches);
  summary.latency = latencies(summary.perception);
  summary.late = count_late(summary.perception, arrivals, period);
  summary.makespan = schedule.makespan;
  summary.throughput_hz = slowest_rate(summary.branches);
  summary.processed = count_processed(summary.branches);
  add_engines(schedule, summary);
  summary.energy = timeline::energy(schedule, record, machine);
  const double total = summary.energy.total();
  if (summary.processed > 0) {
    summary.energy_per_frame_j = total / static_cast<double>(summary.processed);
  }
  if (summary.makespan > 0)
    summary.mean_power_w = total * 1e9 / static_cast<double>(summary.makespan);
  return summary;
}

}  // namespace partita::partition
