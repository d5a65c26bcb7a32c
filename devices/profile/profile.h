// DeviceProfile: everything that Partita knows about one device, read from one YAML file. A new
// device is one new file and no code. The file's schema is the table in schema.cpp; every
// number in it names its source and the source's date, and the loader refuses one that does not.
#ifndef PARTITA_DEVICES_PROFILE_PROFILE_H
#define PARTITA_DEVICES_PROFILE_PROFILE_H

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/profile/error.h"
#include "devices/work.h"

namespace partita::profile {

enum class DeviceType { cpu, gpu, fpga };
std::string_view to_string(DeviceType type);
/// gpu -> CL_DEVICE_TYPE_GPU, fpga -> CL_DEVICE_TYPE_ACCELERATOR, cpu -> CL_DEVICE_TYPE_CPU.
cl_device_type cl_type(DeviceType type);

/// char, short, int, long, float, double, half.
using VectorWidths = std::array<std::uint32_t, 7>;

/// What clGetPlatformInfo and clGetDeviceInfo answer on the real runtime, in OpenCL's own units.
struct OpenclIdentity {
  std::string platform_name, platform_vendor, platform_version, platform_profile;
  std::string platform_extensions;  ///< separated by spaces
  std::string icd_suffix;           ///< cl_khr_icd
  std::string device_name, device_vendor, device_version, driver_version;
  std::string c_version;       ///< CL_DEVICE_OPENCL_C_VERSION
  std::string device_profile;  ///< FULL_PROFILE or EMBEDDED_PROFILE
  std::string extensions;      ///< separated by spaces
  std::uint64_t vendor_id = 0;
  std::uint64_t address_bits = 64;
  std::uint64_t max_compute_units = 0;
  std::uint64_t clock_mhz = 0;
  std::uint64_t max_work_group_size = 0;
  std::array<std::uint64_t, 3> max_work_item_sizes{};
  std::uint64_t local_mem_size = 0;  ///< bytes
  bool local_mem_dedicated = false;  ///< CL_LOCAL, else CL_GLOBAL
  std::uint64_t global_mem_size = 0;
  std::uint64_t max_mem_alloc_size = 0;
  std::uint64_t global_mem_cache_size = 0;      ///< 0: CL_NONE, else CL_READ_WRITE_CACHE
  std::uint64_t global_mem_cacheline_size = 0;  ///< bytes
  std::uint64_t max_constant_buffer_size = 0;
  std::uint64_t max_constant_args = 0;
  std::uint64_t max_parameter_size = 0;
  std::uint64_t mem_base_addr_align_bits = 0;
  std::uint64_t min_data_type_align_size = 0;    ///< bytes
  std::uint64_t profiling_timer_resolution = 0;  ///< ns
  std::uint64_t printf_buffer_size = 0;
  std::uint64_t preferred_work_group_multiple = 1;
  VectorWidths preferred_vector_widths{}, native_vector_widths{};
  bool image_support = false;
  std::uint64_t max_read_image_args = 0, max_write_image_args = 0, max_samplers = 0;
  std::array<std::uint64_t, 2> image2d_max{};
  std::array<std::uint64_t, 3> image3d_max{};
  std::uint64_t image_max_buffer_size = 0, image_max_array_size = 0;
  std::uint64_t single_fp_config = 0;  ///< cl_device_fp_config bits
  std::uint64_t double_fp_config = 0;  ///< 0: no doubles
  bool compiler_available = false, linker_available = false;
  bool out_of_order_queues = false;
  bool host_unified_memory = false;
  bool error_correction = false;
  bool little_endian = true;

  bool doubles() const { return double_fp_config != 0; }
};

/// How fast. Rates are those of one unit; a GPU's unit is an SM, a CPU's a core, an FPGA has one.
struct Performance {
  double clock_hz = 0;  ///< FPGA: of a kernel whose container names none
  std::uint32_t units = 1;
  /// Operations per cycle and unit, SIMD lanes included; 0: the device cannot (doubles on an FPGA).
  std::array<double, kOpClasses> ops_per_cycle{};
  double memory_bandwidth = 0;       ///< B/s, the peak of the memory's data sheet
  double memory_reachable = 1;       ///< share of it that all clients together can reach
  double unit_memory_bandwidth = 0;  ///< B/s, the most that one core draws; 0: no such limit
  double local_bandwidth = 0;        ///< B per cycle and unit of __local memory; 0: ordinary memory
  double copy_bandwidth = 0;         ///< B/s of a copy inside the device's memory (bytes copied)
  /// Share of peak operations and of peak bandwidth that well-written code of a WorkKind reaches.
  std::array<double, kWorkKinds> compute_efficiency{};
  std::array<double, kWorkKinds> memory_efficiency{};
  // GPU only: what fits on one SM, and how many work-items hide its latencies.
  std::uint32_t max_groups_per_unit = 0, max_items_per_unit = 0;
  std::uint64_t local_mem_per_unit = 0;    ///< bytes
  std::uint32_t items_to_fill_unit = 0;    ///< resident items for full arithmetic rate of one SM
  std::uint32_t items_to_fill_memory = 0;  ///< resident items on the device for full bandwidth
  // FPGA only: one AXI master moves at most port_bytes per kernel clock cycle.
  std::uint32_t port_bytes = 0;
};

/// What the host pays to drive the device, in nanoseconds.
struct HostCosts {
  std::uint64_t api_call_ns = 0;  ///< added to the host clock by an enqueue or a wait
  std::uint64_t submit_ns = 0;    ///< QUEUED to SUBMIT
  std::uint64_t launch_ns = 0;    ///< part of every kernel's duration on the device
  std::uint64_t wakeup_ns = 0;    ///< from END to a blocked host thread running again
};

/// How the device is joined to its node's host.
struct HostLink {
  bool shared_memory = false;    ///< same DRAM: copies are memcpy in it, maps move nothing
  double bandwidth = 0;          ///< B/s per direction, payload; memcpy rate if shared
  std::uint64_t latency_ns = 0;  ///< per transfer
};

struct Power {
  double idle_w = 0;
  double busy_w = 0;  ///< whole device at full load, idle power included, memory traffic aside
  double transfer_j_per_byte = 0;  ///< memory and link energy of one byte moved
};

/// Resources of an FPGA; of an estimate, what a design takes of them.
struct Area {
  std::uint64_t lut = 0, ff = 0, bram36 = 0, uram = 0, dsp = 0;
  bool operator==(const Area&) const = default;
};

struct Fabric {
  Area area;
  std::uint64_t bitstream_bytes = 0;
  std::uint64_t full_load_ns = 0;     ///< loading a container into the whole device
  std::uint64_t partial_load_ns = 0;  ///< swapping one reconfigurable region
};

/// Where a number came from: `key` is its path in the file ("performance.clock").
struct Provenance {
  std::string key, unit, source, date;
  double value = 0;
  int line = 0;
};

struct DeviceProfile {
  std::string id;  ///< the file's stem: "gtx1060"
  std::string name, vendor;
  DeviceType type = DeviceType::cpu;
  OpenclIdentity opencl;
  Performance performance;
  HostCosts host;
  HostLink link;  ///< bandwidth 0 for a CPU that is only a host
  Power power;
  Fabric fabric;         ///< all zero unless type is fpga
  double price_usd = 0;  ///< 0: paid with the host CPU, on the same board or module
  /// Relative: a time predicted as t may be t (1 - u) to t (1 + u) on the real device.
  std::optional<double> uncertainty;
  std::vector<Provenance> numbers;  ///< every number of the file
  std::string path;
  std::string content_hash;  ///< FNV-1a 64 of the file's bytes, 16 hex digits
};

/// Where nothing states how far predictions may be off: more than the 10 % that analytic models of
/// well-known devices are published with, since most of our devices' constants are not measured.
inline constexpr double kDefaultUncertainty = 0.25;
inline double uncertainty(const DeviceProfile& profile) {
  return profile.uncertainty.value_or(kDefaultUncertainty);
}

/// Reads one profile strictly: unknown or missing keys, wrong types or units, numbers out of range
/// or without source and date throw Error ("<file>:<line>: <key>: …, expected … in [a, b]").
DeviceProfile load_device(const std::string& path);
/// The same from text; `path` only names it in errors. Used by tests and tools.
DeviceProfile parse_device(const std::string& text, const std::string& path);

/// 16 hex digits of FNV-1a 64.
std::string hash_bytes(std::string_view bytes);

}  // namespace partita::profile

#endif  // PARTITA_DEVICES_PROFILE_PROFILE_H
