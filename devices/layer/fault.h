// Faults on demand, in one place: PARTITA_FAULT makes an emulated device fail as real ones do.
//
//   PARTITA_FAULT = FAULT { "," FAULT }
//   FAULT = "device=" NAME ":" KIND
//   KIND  = "lost@" N              from the N-th command on (1 is the first) every call that needs
//                                  the device fails, and CL_DEVICE_AVAILABLE is false
//         | "build-fail"           no program can be built
//         | "out-of-memory@" N     the N-th allocation fails
//         | "stall@" N "=" MS      the N-th command starts MS milliseconds of predicted time late
#ifndef PARTITA_DEVICES_LAYER_FAULT_H
#define PARTITA_DEVICES_LAYER_FAULT_H

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <CL/cl.h>

namespace partita::layer {

enum class FaultKind { lost, build_fail, out_of_memory, stall };

struct Fault {
  std::string device;
  FaultKind kind = FaultKind::lost;
  std::uint64_t at = 0;        ///< counted from 1
  std::uint64_t stall_ns = 0;  ///< stall only
  bool operator==(const Fault&) const = default;
};

/// Strict; throws std::invalid_argument with one line that names the part it cannot read.
std::vector<Fault> parse_faults(const std::string& text);

/// What a device counts towards its faults. Thread-safe.
class FaultState {
 public:
  void add(const Fault& fault) { faults_.push_back(fault); }

  /// One more command is about to be enqueued: CL_SUCCESS, or the error it fails with. A stall is
  /// given as `stall_ns` to wait first.
  cl_int next_command(std::uint64_t& stall_ns);
  /// One more allocation: CL_SUCCESS or CL_MEM_OBJECT_ALLOCATION_FAILURE.
  cl_int next_allocation();
  bool build_fails() const;
  bool lost() const { return lost_; }

 private:
  std::vector<Fault> faults_;
  std::atomic<std::uint64_t> commands_{0}, allocations_{0};
  std::atomic<bool> lost_{false};
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_FAULT_H
