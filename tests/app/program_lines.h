// What a task enqueued, and what its program says that it would, as lines of text to be compared.
#ifndef PARTITA_TESTS_APP_PROGRAM_LINES_H
#define PARTITA_TESTS_APP_PROGRAM_LINES_H

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "devices/timeline/record.h"
#include "host/app/workload.h"

namespace partita::app {

/// Everything of a Work; the record keeps the geometry apart from it.
inline std::string described(const Work& work, const model::Launch& launch) {
  std::string text = fmt::format("{} [{}] {} {} {} {} {} {}x{}x{}", model::to_string(work.kind),
                                 fmt::join(work.ops, " "), work.read_issued, work.written_issued,
                                 work.read_unique, work.written_unique, work.local_bytes,
                                 launch.groups, launch.group_items, launch.local_bytes);
  for (std::uint32_t i = 0; i < work.loop_count; ++i) {
    const WorkLoop& loop = work.loops[i];
    text += fmt::format(" {}*{}+{}", loop.trips, loop.ii, loop.depth);
  }
  return text;
}

inline std::string described(const Work& work) {
  return described(work, {work.groups, work.group_items, work.group_local_bytes});
}

/// What a thread did, a line each; waiting for the sensors is not the tasks' affair.
inline std::vector<std::string> recorded(const timeline::Record& record, const std::string& name) {
  const timeline::RecordedThread* thread = nullptr;  // the last run's
  for (const auto& candidate : record.threads) {
    if (candidate.name == name) thread = &candidate;
  }
  std::vector<std::string> lines;
  if (thread == nullptr) return lines;
  for (const timeline::Action& action : thread->actions) {
    if (action.type == timeline::ActionType::wait_until) continue;
    if (action.type != timeline::ActionType::command) {
      lines.push_back(action.type == timeline::ActionType::finish ? "finish"
                      : action.type == timeline::ActionType::wait ? "wait"
                                                                  : "something else");
      continue;
    }
    const timeline::RecordedCommand& command = record.commands[action.arg];
    if (command.kind == timeline::CommandKind::sensor_input) continue;
    std::string line = fmt::format("frame {} {} {} {}", command.frame, record.names[command.task],
                                   timeline::to_string(command.kind), record.names[command.name]);
    // A copy reads and writes each byte.
    const std::uint64_t bytes =
        command.kind == timeline::CommandKind::copy ? command.demand.bytes / 2 : command.bytes;
    if (bytes > 0) line += fmt::format(" {} B", bytes);
    if (command.work != timeline::kNone) {
      line += fmt::format(" {}", described(record.works[command.work], command.launch));
    }
    lines.push_back(line);
  }
  return lines;
}

/// The same from the programs.
inline std::vector<std::string> exported(const partition::TaskWork& task,
                                         const std::vector<std::int64_t>& frames,
                                         std::size_t variant) {
  using partition::StepKind;
  static constexpr const char* kKinds[] = {"write", "read", "kernel", "copy", "host_step", ""};
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < task.frames.size(); ++k) {
    for (const partition::Step& step : task.frames[k]) {
      if (step.kind == StepKind::finish) {
        lines.push_back("finish");
        continue;
      }
      std::string line = fmt::format("frame {} {} {} {}", frames[k], task.name,
                                     kKinds[static_cast<std::size_t>(step.kind)], step.name);
      if (step.bytes > 0) line += fmt::format(" {} B", step.bytes);
      if (step.kind == StepKind::kernel) {
        line += fmt::format(" {}", described(task.works[step.work][variant]));
      }
      if (step.kind == StepKind::host) {
        line += fmt::format(" {}", described(task.works[step.work][0], {}));
      }
      lines.push_back(line);
      if (step.blocking) lines.push_back("wait");
    }
  }
  return lines;
}

/// Where two sequences part, for people.
inline void expect_same(const std::vector<std::string>& enqueued,
                        const std::vector<std::string>& program) {
  const auto [a, b] =
      std::mismatch(enqueued.begin(), enqueued.end(), program.begin(), program.end());
  if (a == enqueued.end() && b == program.end()) return;
  ADD_FAILURE() << "step " << a - enqueued.begin()
                << "\n  enqueued: " << (a == enqueued.end() ? "nothing" : *a)
                << "\n  program:  " << (b == program.end() ? "nothing" : *b);
}

}  // namespace partita::app

#endif  // PARTITA_TESTS_APP_PROGRAM_LINES_H
