// Work: what one launch of a kernel, or one host step, costs; and the OpenCL extension that carries
// it to the emulation layer. This is the only header that the host program, the layer and the
// simulator share. It is plain data: no OpenCL call, no allocation, no dependency.
//
// A Work is a property of the algorithm's shape, not of a machine: the same Work gives the
// predicted time on a declared device, the share of the roofline reached on a real one, and the
// estimate for a device that nobody has.
#ifndef PARTITA_DEVICES_WORK_H
#define PARTITA_DEVICES_WORK_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <CL/cl.h>

namespace partita {

/// Classes of operations with a throughput of their own on at least one kind of device.
/// Address arithmetic and loop control are left out: every device hides or pays them differently.
enum class OpClass : std::uint32_t {
  int_add,        ///< add, subtract, compare, min, max, select, logic, shift, conversion
  int_mul,        ///< multiply, multiply-add on integers
  int_special,    ///< popcount, count leading zeros, integer division and remainder
  float_add,      ///< add, subtract, compare, min, max, conversion
  float_mul,      ///< multiply
  float_fma,      ///< fused multiply-add; counts as one operation here and two FLOP in reports
  float_special,  ///< division, square root, exp, log, sin, cos
  double_add,
  double_mul,
  double_fma,
  double_special,
  atomic,  ///< atomic read-modify-write, local or global
  count_,
};
inline constexpr std::size_t kOpClasses = static_cast<std::size_t>(OpClass::count_);

/// What kind of work it is. A profile states, per kind, which share of its peak a well-written
/// kernel of that kind reaches; the shares come from published measurements, never from the
/// results that we want to predict.
enum class WorkKind : std::uint32_t {
  stream,   ///< element-wise: bound by memory bandwidth
  stencil,  ///< neighbourhood operations on images
  gather,   ///< data-dependent addresses: descriptors, tables, candidate lists
  dense,    ///< convolutions and matrix products with reuse
  reduce,   ///< reductions, scans, compaction, histograms
  serial,   ///< no parallelism to speak of: host steps, control
  count_,
};
inline constexpr std::size_t kWorkKinds = static_cast<std::size_t>(WorkKind::count_);

/// One loop (nest) of an FPGA circuit: `trips` iterations start every `ii` cycles and the last one
/// leaves the pipeline after `depth` more. Loops of one launch run one after the other.
struct WorkLoop {
  std::uint64_t trips = 0;
  std::uint32_t ii = 1;
  std::uint32_t depth = 0;
};
inline constexpr std::size_t kMaxWorkLoops = 8;

/// The cost of one launch. Bytes *issued* are what load and store instructions to global memory ask
/// for (which counting can check); bytes *unique* are what must cross the memory bus at least once
/// (which the roofline uses).
struct Work {
  std::uint32_t struct_size = sizeof(Work);  ///< lets an older layer refuse a newer host plainly
  WorkKind kind = WorkKind::stream;
  std::array<std::uint64_t, kOpClasses> ops{};
  std::uint64_t read_issued = 0;
  std::uint64_t written_issued = 0;
  std::uint64_t read_unique = 0;
  std::uint64_t written_unique = 0;
  std::uint64_t local_bytes = 0;  ///< traffic to __local memory (GPU variants), read plus written
  /// The launch's geometry in the variant that is charged (which need not be the one that runs): a
  /// GPU's occupancy follows from it. Zero groups: as enqueued.
  std::uint64_t groups = 0;
  std::uint64_t group_items = 0;
  std::uint64_t group_local_bytes = 0;  ///< __local memory of one work-group
  std::uint32_t loop_count = 0;         ///< FPGA variants only: entries of `loops` in use
  std::uint32_t estimated = 0;  ///< 1: derived from compiled code, not declared by the author
  std::array<WorkLoop, kMaxWorkLoops> loops{};

  std::uint64_t& operator[](OpClass c) { return ops[static_cast<std::size_t>(c)]; }
  std::uint64_t operator[](OpClass c) const { return ops[static_cast<std::size_t>(c)]; }
  std::uint64_t issued() const { return read_issued + written_issued; }
  std::uint64_t unique() const { return read_unique + written_unique; }
  /// Appends a loop; a ninth is merged into the last one, so that cycles are never lost.
  void add_loop(std::uint64_t trips, std::uint32_t ii, std::uint32_t depth) {
    if (loop_count < kMaxWorkLoops) {
      loops[loop_count++] = {trips, ii, depth};
    } else {
      WorkLoop& last = loops.back();
      last = {last.trips * last.ii + trips * ii, 1, last.depth + depth};
    }
  }
  /// Cycles of an FPGA variant: the sum over its loops of trips × ii + depth.
  std::uint64_t cycles() const {
    std::uint64_t sum = 0;
    for (std::uint32_t i = 0; i < loop_count; ++i) {
      sum += loops[i].trips * loops[i].ii + loops[i].depth;
    }
    return sum;
  }
};
static_assert(std::is_trivially_copyable_v<Work> && std::is_standard_layout_v<Work>);

/// An on-chip memory of an FPGA variant: `banks` independent memories of `depth` words each.
struct OnChipBuffer {
  std::uint64_t depth = 0;
  std::uint32_t width_bits = 0;
  std::uint32_t banks = 1;
  std::uint32_t ports = 2;  ///< simultaneous accesses a bank serves; a BRAM has two
};
inline constexpr std::size_t kMaxBuffers = 12;

/// What an FPGA variant instantiates in hardware, from which the area is estimated: memories, and
/// operators after unrolling (how many adders, multipliers, … exist side by side, by OpClass).
struct FpgaDesign {
  std::array<OnChipBuffer, kMaxBuffers> buffers{};
  std::uint32_t buffer_count = 0;
  std::array<std::uint32_t, kOpClasses> operators{};
  std::uint32_t operand_bits = 16;  ///< typical width of an integer operator
  std::uint32_t memory_ports = 1;   ///< AXI masters to the memory controller
  std::uint32_t compute_units = 1;  ///< replication
};

// ---- The extension ------------------------------------------------------------------------------
//
// Found with clGetExtensionFunctionAddressForPlatform under the names below. A real driver has
// none of them: the host program then gets null pointers and nothing happens. All functions are
// thread-safe and speak about the calling thread. All return CL_SUCCESS or an OpenCL error code.

inline constexpr const char* kExtensionName = "cl_partita_predicted_time";

/// Names the calling host thread, ranks it (equal virtual times are served in order of rank) and
/// places it on the CPU of the node on which `near` sits (null: the machine's main node).
using BindThreadFn = cl_int(CL_API_CALL*)(const char* name, cl_uint rank, cl_device_id near);
inline constexpr const char* kBindThread = "clBindHostThreadPARTITA";

/// Task and frame that the thread's following commands and host steps belong to.
using SetLabelFn = cl_int(CL_API_CALL*)(const char* task, cl_long frame);
inline constexpr const char* kSetLabel = "clSetLabelPARTITA";

/// Declares the Work of the next kernel that the calling thread enqueues on `queue`.
using SetWorkFn = cl_int(CL_API_CALL*)(cl_command_queue queue, const Work* work);
inline constexpr const char* kSetWork = "clSetWorkPARTITA";

/// A host step that has just been computed: occupies a core of the thread's node for its time.
using HostStepFn = cl_int(CL_API_CALL*)(const char* name, const Work* work);
inline constexpr const char* kHostStep = "clHostStepPARTITA";

/// `bytes` of sensor data travel from the node of the sensors to the thread's node, from the time
/// that the thread last waited for (the trigger); the thread waits for them. Free when both are the same node. A frame's data of one name travel to a node
/// once: a second thread that asks for them waits for the same arrival.
using SensorInputFn = cl_int(CL_API_CALL*)(const char* name, cl_ulong bytes);
inline constexpr const char* kSensorInput = "clSensorInputPARTITA";

/// The thread sleeps until the virtual time `ns` (a sensor's trigger); no effect if it has passed.
using WaitUntilFn = cl_int(CL_API_CALL*)(cl_ulong ns);
inline constexpr const char* kWaitUntil = "clWaitUntilPARTITA";

/// The thread's host clock, in virtual nanoseconds.
using HostClockFn = cl_int(CL_API_CALL*)(cl_ulong* ns);
inline constexpr const char* kHostClock = "clGetHostClockPARTITA";

/// Writes the recorded graph (commands, Work, edges, measured times) to a file of JSON lines,
/// whole or not at all. Call when all queues are finished.
using ExportRecordFn = cl_int(CL_API_CALL*)(const char* path);
inline constexpr const char* kExportRecord = "clExportRecordPARTITA";

/// clGetDeviceInfo: name of the node that the emulated device sits on (char[]).
inline constexpr cl_device_info kDeviceNode = 0x5041;
/// clGetDeviceInfo: name of the profile that the device is emulated from (char[]).
inline constexpr cl_device_info kDeviceProfile = 0x5042;

}  // namespace partita

#endif  // PARTITA_DEVICES_WORK_H
