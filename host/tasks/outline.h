// Outlines: tasks whose kernels the pipeline does not have yet take part in a prediction by their
// Work, which follows from the algorithm alone: operations counted from its formulas, bytes from its
// data. No published time goes in. When the kernels come, their specs replace these.
#ifndef PARTITA_HOST_TASKS_OUTLINE_H
#define PARTITA_HOST_TASKS_OUTLINE_H

#include <initializer_list>
#include <string>
#include <utility>

#include "host/tasks/program.h"

namespace partita::tasks {

/// A kernel that can be costed and not run: no text, no arguments, no golden reference.
inline runtime::KernelSpec outline_kernel(std::string task, std::string name) {
  runtime::KernelSpec spec;
  spec.task = std::move(task);
  spec.name = std::move(name);
  spec.variants = {runtime::kVariants.begin(), runtime::kVariants.end()};
  return spec;
}

inline std::uint64_t count(const runtime::Shape& shape, const char* name) {
  return static_cast<std::uint64_t>(shape[name]);
}

inline std::uint64_t ceil_div(std::uint64_t a, std::uint64_t b) {
  return (a + b - 1) / b;
}

/// `groups` work-groups (at least one) of `items` work-items.
inline runtime::LaunchGeometry groups_of(std::uint64_t groups, std::uint64_t items) {
  const std::size_t some = groups == 0 ? 1 : groups;
  return {{some * items, 1, 1}, {items, 1, 1}};
}

inline void set_operators(FpgaDesign& design,
                          std::initializer_list<std::pair<OpClass, std::uint32_t>> operators) {
  for (const auto& [op, n] : operators) design.operators[static_cast<std::size_t>(op)] = n;
}

inline void set_buffers(FpgaDesign& design, std::initializer_list<OnChipBuffer> buffers) {
  for (const OnChipBuffer& buffer : buffers) design.buffers[design.buffer_count++] = buffer;
}

/// Bytes of which each is asked for once.
inline void set_traffic(Work& work, std::uint64_t read, std::uint64_t written) {
  work.read_issued = work.read_unique = read;
  work.written_issued = work.written_unique = written;
}

}  // namespace partita::tasks

#endif  // PARTITA_HOST_TASKS_OUTLINE_H
