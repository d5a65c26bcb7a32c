// Workload: what the tasks of a pipeline ask of a machine, as data. A task's frame is a Program,
// the sequence of what its host thread does: writes, kernels, reads, host steps. It is the same
// sequence on every device; only the Work of a kernel differs by variant. Tasks export it
// (host/tasks), from the counts of a recorded run or from typical ones; no OpenCL is needed to use
// it.
#ifndef PARTITA_PARTITION_GRAPH_WORKLOAD_H
#define PARTITA_PARTITION_GRAPH_WORKLOAD_H

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "devices/model/model.h"
#include "devices/profile/profile.h"
#include "devices/work.h"

namespace partita::partition {

/// Variants are named after the type of device that they are written for.
inline constexpr std::size_t kVariants = 3;
inline std::size_t variant_index(profile::DeviceType type) {
  return static_cast<std::size_t>(type);
}

enum class StepKind : std::uint8_t {
  write,   ///< `bytes` from the task's host to its device
  read,    ///< `bytes` from its device to its host
  kernel,  ///< a launch, in-order
  copy,    ///< `bytes` copied inside the device's memory
  host,    ///< a declared host step
  finish,  ///< the host waits for everything enqueued
};

struct Step {
  StepKind kind = StepKind::kernel;
  std::string name;         ///< of a kernel or a host step
  std::uint64_t bytes = 0;  ///< write, read, copy
  bool blocking = false;    ///< read, write: the host waits until it is done
  std::uint32_t work = 0;   ///< kernel, host: index into TaskWork::works
  /// kernel on an FPGA: its memory ports and compute units; clock_hz 0: the profile's clock.
  model::Circuit circuit = {};
  bool operator==(const Step& o) const {
    return kind == o.kind && name == o.name && bytes == o.bytes && blocking == o.blocking &&
           work == o.work && circuit.clock_hz == o.circuit.clock_hz &&
           circuit.memory_ports == o.circuit.memory_ports &&
           circuit.compute_units == o.circuit.compute_units;
  }
};
std::string_view to_string(StepKind kind);

/// A kernel's Work by variant_index(); a host step uses only [0]. Geometry is in the Work.
using VariantWork = std::array<Work, kVariants>;
using Program = std::vector<Step>;

struct Output {
  std::string name;  ///< "stereo", "features"
  std::uint64_t bytes = 0;
};

struct TaskWork {
  std::string name;
  /// It takes part by its Work alone, counted from the algorithm and not from kernels, and is marked
  /// as such.
  bool outline = false;
  /// Has no kernels: it runs on the CPU of a node.
  bool host_only = false;
  std::array<bool, kVariants> variants{};  ///< there is one for this type of device
  std::vector<VariantWork> works;
  /// One per recorded frame (jitter), or a single one, which every frame repeats. An empty program:
  /// the task did nothing on that frame.
  std::vector<Program> frames;
  std::vector<Output> outputs;
  profile::Area area;  ///< of its FPGA kernels together, estimated or declared
  bool area_declared = false;
};

struct Workload {
  std::string origin;  ///< for people: "30 frames of scenario (seed 1)", "typical counts"
  std::string hash;    ///< of everything above, 16 hex digits
  std::vector<TaskWork> tasks;

  const TaskWork* find(std::string_view task) const;
  /// Frames after which it repeats: the longest TaskWork::frames.
  std::size_t frame_count() const;
};

/// 16 hex digits over origin and tasks; what Workload::hash should be.
std::string content_hash(const Workload& workload);

/// Throws profile::Error, one line that names task, frame and step, for a Work index that does not
/// exist, a Work of an unknown kind, a launch without groups in a variant that the task has, device
/// steps in a task without a variant, a task without frames or with neither one nor frame_count()
/// of them, and names that are empty or twice there.
void check(const Workload& workload);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_GRAPH_WORKLOAD_H
