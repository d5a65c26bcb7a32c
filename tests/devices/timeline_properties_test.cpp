// Properties that hold for every program: checked on some hundreds of random ones.
#include <algorithm>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/devices/timeline_programs.h"

namespace partita::timeline::test {
namespace {

void expect_invariants(const Record& record, const Schedule& schedule) {
  for (const ScheduledCommand& s : schedule.commands) {
    const RecordedCommand& c = record.commands[s.command];
    if (!s.resolved) continue;
    EXPECT_LE(s.times.queued, s.times.submit);
    EXPECT_LE(s.times.submit, s.times.start);
    EXPECT_LE(s.times.start, s.times.end);
    for (std::uint32_t i = 0; i < c.wait_count; ++i) {
      const ScheduledCommand& on = schedule.commands[record.waits[c.first_wait + i]];
      ASSERT_TRUE(on.resolved);
      EXPECT_GE(s.times.start, on.times.end);
    }
    EXPECT_LE(s.times.end, schedule.makespan);
  }
  // No engine twice at once.
  std::map<EngineId, Ns> until;
  for (const Occupation& o : schedule.occupations) {
    EXPECT_LT(o.start, o.end);
    EXPECT_GE(o.start, until[o.engine]);
    until[o.engine] = o.end;
  }
  for (const double share : schedule.utilisation()) {
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 1);
  }
}

void expect_queue_order(const Record& record, const Schedule& schedule, std::uint32_t thread) {
  std::map<QueueId, Ns> last, all, barrier;
  for (const Action& action : record.threads[thread].actions) {
    if (action.type != ActionType::command) continue;
    const RecordedCommand& c = record.commands[action.arg];
    const ScheduledCommand& s = schedule.commands[action.arg];
    if (c.queue == kNone || !s.resolved) continue;
    if (!record.queues[c.queue].out_of_order) {
      EXPECT_GE(s.times.start, last[c.queue]);
      last[c.queue] = s.times.end;
      continue;
    }
    EXPECT_GE(s.times.start, barrier[c.queue]);
    const bool marks = c.kind == CommandKind::marker || c.kind == CommandKind::barrier;
    if (marks && !c.has_list) {
      EXPECT_GE(s.times.start, all[c.queue]);
    }
    all[c.queue] = std::max(all[c.queue], s.times.end);
    if (c.kind == CommandKind::barrier) {
      barrier[c.queue] = std::max(barrier[c.queue], s.times.end);
    }
  }
}

/// Bytes per nanosecond that all commands together draw from a memory never exceed what it has:
/// per command at least bytes / (END - START) on average, so compare over whole busy stretches.
void expect_bandwidth(const Record& record, const Schedule& schedule, std::uint32_t node) {
  const Layout& layout = record.layout;
  double bytes = 0;
  Ns first = ~Ns{0}, last = 0;
  for (const ScheduledCommand& s : schedule.commands) {
    const RecordedCommand& c = record.commands[s.command];
    if (!s.resolved || s.status < 0 || c.queue == kNone || s.engine == kNone) continue;
    const LayoutDevice& device = layout.devices[record.queues[c.queue].device];
    if (!device.shared_memory || device.node != node || c.kind != CommandKind::kernel) continue;
    bytes += static_cast<double>(c.demand.bytes);
    first = std::min(first, s.times.start);
    last = std::max(last, s.times.end);
  }
  if (last <= first) return;
  EXPECT_LE(bytes * 1e9 / static_cast<double>(last - first),
            static_cast<double>(layout.nodes[node].memory_bps) * 1.0001);
}

TEST(TimelineProperties, ReplayOfOneThreadEqualsLive) {
  for (std::uint32_t seed = 1; seed <= 150; ++seed) {
    ProgramOptions options;
    options.steps = 250;
    options.user_events = seed % 2 == 0;
    std::vector<Occupation> live;
    const Record record = run_programs(seed, seed, options, &live);
    EXPECT_FALSE(record.racing());
    const Schedule schedule = replay(record);
    ASSERT_EQ(schedule.commands.size(), record.commands.size());
    for (std::size_t i = 0; i < record.commands.size(); ++i) {
      ASSERT_EQ(schedule.commands[i].resolved, record.commands[i].resolved) << seed << " " << i;
      ASSERT_EQ(schedule.commands[i].times, record.commands[i].live) << seed << " command " << i;
    }
    EXPECT_EQ(schedule.occupations.size(), live.size());
    expect_invariants(record, schedule);
    expect_queue_order(record, schedule, 0);
    expect_bandwidth(record, schedule, 0);
    expect_bandwidth(record, schedule, 1);
  }
}

/// Times by (thread name, position in it), which no interleaving changes.
std::map<std::pair<std::string, std::size_t>, Times> by_thread(const Record& record) {
  const Schedule schedule = replay(record);
  expect_invariants(record, schedule);
  std::map<std::pair<std::string, std::size_t>, Times> times;
  for (const RecordedThread& thread : record.threads) {
    std::size_t n = 0;
    for (const Action& action : thread.actions) {
      if (action.type != ActionType::command) continue;
      times[{thread.name, n++}] = schedule.commands[action.arg].times;
    }
  }
  return times;
}

TEST(TimelineProperties, ReplayDoesNotDependOnTheRace) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    ProgramOptions options;
    options.threads = 3;
    options.steps = 80;
    options.user_events =
        false;  // a wait on a pending event is refused, which would steer programs
    const auto first = by_thread(run_programs(seed, 1, options));
    ASSERT_GT(first.size(), 100u);
    for (std::uint32_t interleaving = 2; interleaving <= 5; ++interleaving) {
      const Record record = run_programs(seed, interleaving * 977, options);
      EXPECT_TRUE(record.racing());
      ASSERT_TRUE(by_thread(record) == first) << "seed " << seed;
    }
  }
}

TEST(TimelineProperties, LiveInvariantsHoldForRacingThreads) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    ProgramOptions options;
    options.threads = 4;
    options.steps = 120;
    std::vector<Occupation> live;
    const Record record = run_programs(seed, seed + 7, options, &live);
    std::sort(live.begin(), live.end(), [](const Occupation& a, const Occupation& b) {
      return std::tie(a.engine, a.start) < std::tie(b.engine, b.start);
    });
    for (std::size_t i = 1; i < live.size(); ++i) {
      if (live[i].engine != live[i - 1].engine) continue;
      EXPECT_GE(live[i].start, live[i - 1].end);
    }
    expect_invariants(record, replay(record));
  }
}

TEST(TimelineProperties, RecordSurvivesItsFile) {
  ProgramOptions options;
  options.threads = 2;
  options.steps = 300;
  const Record record = run_programs(5, 9, options);
  std::stringstream file, again;
  write_record(record, file);
  const Record read = read_record(file, "memory");
  write_record(read, again);
  EXPECT_EQ(file.str(), again.str());
  EXPECT_EQ(read.layout, record.layout);
  const Schedule a = replay(record), b = replay(read);
  ASSERT_EQ(a.commands.size(), b.commands.size());
  for (std::size_t i = 0; i < a.commands.size(); ++i) {
    EXPECT_EQ(a.commands[i].times, b.commands[i].times);
  }
}

}  // namespace
}  // namespace partita::timeline::test
