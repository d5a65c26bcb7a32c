// Program: what a task's host thread does for one frame, as data: the same sequence of writes,
// launches, reads and host steps that the task's class hands to its Session, in terms of the same
// KernelSpecs and HostSpecs. The partitioner predicts from it what a frame costs where, without
// executing anything. Tests hold it against what the task really enqueues.
#ifndef PARTITA_HOST_TASKS_PROGRAM_H
#define PARTITA_HOST_TASKS_PROGRAM_H

#include <cstdint>
#include <string>
#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::tasks {

enum class StepKind { write, read, kernel, copy, host, finish };

struct Step {
  StepKind kind = StepKind::kernel;
  const runtime::KernelSpec* kernel = nullptr;
  const runtime::HostSpec* host = nullptr;
  runtime::Shape shape;     ///< kernel, host
  std::uint64_t bytes = 0;  ///< write, read, copy
  bool blocking = false;    ///< read
};

/// The specs that it is made of must outlive it.
class Program {
 public:
  void write(std::uint64_t bytes) { steps_.push_back({.kind = StepKind::write, .bytes = bytes}); }
  /// The host waits for the bytes; with `later` it goes on.
  void read(std::uint64_t bytes) {
    steps_.push_back({.kind = StepKind::read, .bytes = bytes, .blocking = true});
  }
  void read_later(std::uint64_t bytes) {
    steps_.push_back({.kind = StepKind::read, .bytes = bytes});
  }
  void copy(std::uint64_t bytes) { steps_.push_back({.kind = StepKind::copy, .bytes = bytes}); }
  void launch(const runtime::KernelSpec& kernel, const runtime::Shape& shape) {
    steps_.push_back({.kind = StepKind::kernel, .kernel = &kernel, .shape = shape});
  }
  void host(const runtime::HostSpec& step, const runtime::Shape& shape) {
    steps_.push_back({.kind = StepKind::host, .host = &step, .shape = shape});
  }
  void finish() { steps_.push_back({.kind = StepKind::finish}); }

  const std::vector<Step>& steps() const { return steps_; }

 private:
  std::vector<Step> steps_;
};

/// A kind of message that a task sends to others.
struct Output {
  std::string name;
  std::uint64_t bytes = 0;  ///< of one frame's
};

/// What the vehicle's sensors deliver.
struct Sensors {
  int width = 0, height = 0;  ///< of a picture, one byte a pixel
  double camera_hz = 0;
  double imu_hz = 0;
};

/// A task as the partitioner takes it. With no kernels it runs on the CPU of a node.
struct TaskExport {
  std::string name;
  bool outline = false;  ///< its Work is counted from the algorithm, not from kernels
  std::vector<const runtime::KernelSpec*> kernels;
  std::vector<Program> frames;  ///< one per recorded frame, or a single one for all
  std::vector<Output> outputs;
};

}  // namespace partita::tasks

#endif  // PARTITA_HOST_TASKS_PROGRAM_H
