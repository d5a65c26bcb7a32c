#include "devices/profile/schema.h"

namespace partita::profile {
namespace {

// Ranges are what any device of the last and the next ten years could have; they catch slips of
// units (MHz for Hz, GB for B) rather than describe today's parts.
constexpr double kBytes = 1e15;
constexpr Range kSize{"B", 1, kBytes};
constexpr Range kSizeOrNone{"B", 0, kBytes};
constexpr Range kBandwidth{"B/s", 1e6, 1e14};
constexpr Range kShare{"", 0.001, 1};
constexpr Range kNanoseconds{"ns", 0, 1e9};

using Id = OpenclIdentity;
const Field<Id> kOpenclFields[] = {
    {"platform_name", &Id::platform_name},
    {"platform_vendor", &Id::platform_vendor},
    {"platform_version", &Id::platform_version},
    {"platform_profile", &Id::platform_profile},
    {"icd_suffix", &Id::icd_suffix},
    {"device_name", &Id::device_name},
    {"device_vendor", &Id::device_vendor},
    {"device_version", &Id::device_version},
    {"driver_version", &Id::driver_version},
    {"c_version", &Id::c_version},
    {"device_profile", &Id::device_profile},
    {"vendor_id", &Id::vendor_id, {"", 0, 4294967295.0}},
    {"address_bits", &Id::address_bits, {"bit", 32, 64}},
    {"max_compute_units", &Id::max_compute_units, {"", 1, 65536}},
    {"clock_mhz", &Id::clock_mhz, {"MHz", 1, 100000}},
    {"max_work_group_size", &Id::max_work_group_size, {"", 1, 4294967295.0}},
    {"local_mem_size", &Id::local_mem_size, kSize},
    {"local_mem_dedicated", &Id::local_mem_dedicated},
    {"global_mem_size", &Id::global_mem_size, kSize},
    {"max_mem_alloc_size", &Id::max_mem_alloc_size, kSize},
    {"global_mem_cache_size", &Id::global_mem_cache_size, kSizeOrNone},
    {"global_mem_cacheline_size", &Id::global_mem_cacheline_size, kSizeOrNone},
    {"max_constant_buffer_size", &Id::max_constant_buffer_size, kSize},
    {"max_constant_args", &Id::max_constant_args, {"", 1, 65536}},
    {"max_parameter_size", &Id::max_parameter_size, {"B", 64, 1048576}},
    {"mem_base_addr_align_bits", &Id::mem_base_addr_align_bits, {"bit", 8, 1048576}},
    {"min_data_type_align_size", &Id::min_data_type_align_size, {"B", 1, 4096}},
    {"profiling_timer_resolution", &Id::profiling_timer_resolution, {"ns", 1, 1e9}},
    {"printf_buffer_size", &Id::printf_buffer_size, kSizeOrNone},
    {"preferred_work_group_multiple", &Id::preferred_work_group_multiple, {"", 1, 4096}},
    {"compiler_available", &Id::compiler_available},
    {"linker_available", &Id::linker_available},
    {"out_of_order_queues", &Id::out_of_order_queues},
    {"host_unified_memory", &Id::host_unified_memory},
    {"error_correction", &Id::error_correction},
    {"little_endian", &Id::little_endian},
};

void read_images(const Reader& reader, Id& to) {
  const Field<Id> fields[] = {
      {"max_read_image_args", &Id::max_read_image_args, {"", 1, 65536}},
      {"max_write_image_args", &Id::max_write_image_args, {"", 1, 65536}},
      {"max_samplers", &Id::max_samplers, {"", 1, 65536}},
      {"max_buffer_size", &Id::image_max_buffer_size, {"", 1, 1e12}},
      {"max_array_size", &Id::image_max_array_size, {"", 1, 65536}},
  };
  read_fields<Id>(reader, fields, to, {"max_2d", "max_3d"});
  const auto two = reader.integers("max_2d", 2, {"", 1, 1e6});
  const auto three = reader.integers("max_3d", 3, {"", 1, 1e6});
  std::copy(two.begin(), two.end(), to.image2d_max.begin());
  std::copy(three.begin(), three.end(), to.image3d_max.begin());
  to.image_support = true;
}

void read_widths(const Reader& reader, std::string_view key, VectorWidths& to) {
  const auto widths = reader.integers(key, to.size(), {"", 0, 64});
  std::copy(widths.begin(), widths.end(), to.begin());
}

const std::vector<std::pair<std::string_view, std::uint64_t>> kFpBits{
    {"denorm", CL_FP_DENORM},
    {"inf_nan", CL_FP_INF_NAN},
    {"round_to_nearest", CL_FP_ROUND_TO_NEAREST},
    {"round_to_zero", CL_FP_ROUND_TO_ZERO},
    {"round_to_inf", CL_FP_ROUND_TO_INF},
    {"fma", CL_FP_FMA},
    {"correctly_rounded_divide_sqrt", CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT},
    {"soft_float", CL_FP_SOFT_FLOAT},
};

/// A section with one number for every name; nothing may be left out.
template <std::size_t n>
void read_each(const Reader& reader, const std::array<std::string_view, n>& names, Range range,
               std::array<double, n>& to) {
  reader.allow({names.begin(), names.end()});
  for (std::size_t i = 0; i < n; ++i) to[i] = reader.number(names[i], range);
}

void read_occupancy(const Reader& reader, Performance& to) {
  using P = Performance;
  const Field<P> fields[] = {
      {"max_groups_per_unit", &P::max_groups_per_unit, {"", 1, 1024}},
      {"max_items_per_unit", &P::max_items_per_unit, {"", 1, 65536}},
      {"local_mem_per_unit", &P::local_mem_per_unit, kSize},
      {"items_to_fill_unit", &P::items_to_fill_unit, {"", 1, 65536}},
      {"items_to_fill_memory", &P::items_to_fill_memory, {"", 1, 1e8}},
  };
  read_fields<P>(reader, fields, to);
}

}  // namespace

std::optional<double> read_uncertainty(const Reader& reader) {
  if (!reader.has("uncertainty")) return std::nullopt;
  return reader.number("uncertainty", {"", 0, 0.95});
}

void read_opencl(const Reader& reader, OpenclIdentity& to) {
  read_fields<Id>(
      reader, kOpenclFields, to,
      {"platform_extensions", "extensions", "max_work_item_sizes", "preferred_vector_widths",
       "native_vector_widths", "images", "single_fp_config", "double_fp_config"});
  to.platform_extensions = reader.words("platform_extensions");
  to.extensions = reader.words("extensions");
  const auto sizes = reader.integers("max_work_item_sizes", 3, {"", 1, 4294967295.0});
  std::copy(sizes.begin(), sizes.end(), to.max_work_item_sizes.begin());
  read_widths(reader, "preferred_vector_widths", to.preferred_vector_widths);
  read_widths(reader, "native_vector_widths", to.native_vector_widths);
  to.single_fp_config = reader.bits("single_fp_config", kFpBits);
  if (reader.has("double_fp_config"))
    to.double_fp_config = reader.bits("double_fp_config", kFpBits);
  if (reader.has("images")) read_images(reader.section("images"), to);
  for (const char* key : {"platform_profile", "device_profile"}) {
    reader.choice(key, {"FULL_PROFILE", "EMBEDDED_PROFILE"});
  }
  if (to.max_mem_alloc_size > to.global_mem_size) {
    reader.fail("max_mem_alloc_size", "larger than global_mem_size, expected at most that");
  }
}

void read_performance(const Reader& reader, DeviceType type, Performance& to) {
  using P = Performance;
  const Field<P> fields[] = {
      {"clock", &P::clock_hz, {"Hz", 1e6, 2e10}},
      {"units", &P::units, {"", 1, 65536}},
      {"memory_bandwidth", &P::memory_bandwidth, kBandwidth},
      {"memory_reachable", &P::memory_reachable, kShare},
      {"copy_bandwidth", &P::copy_bandwidth, kBandwidth},
  };
  std::vector<std::string_view> extra{"ops_per_cycle", "compute_efficiency", "memory_efficiency"};
  if (type == DeviceType::gpu) extra.insert(extra.end(), {"occupancy", "local_bytes_per_cycle"});
  if (type == DeviceType::fpga) extra.push_back("port_bytes");
  if (type == DeviceType::cpu) extra.push_back("unit_memory_bandwidth");
  read_fields<P>(reader, fields, to, extra);
  read_each(reader.section("ops_per_cycle"), kOpClassNames, {"", 0, 1e6}, to.ops_per_cycle);
  read_each(reader.section("compute_efficiency"), kWorkKindNames, kShare, to.compute_efficiency);
  read_each(reader.section("memory_efficiency"), kWorkKindNames, kShare, to.memory_efficiency);
  for (std::size_t i = 0; i < kWorkKinds; ++i) {
    if (to.memory_efficiency[i] > to.memory_reachable) {
      reader.section("memory_efficiency")
          .fail(kWorkKindNames[i], "above memory_reachable, expected at most that");
    }
  }
  if (type == DeviceType::gpu) {
    read_occupancy(reader.section("occupancy"), to);
    to.local_bandwidth = reader.number("local_bytes_per_cycle", {"B", 1, 65536});
  } else if (type == DeviceType::fpga) {
    to.port_bytes = static_cast<std::uint32_t>(reader.integer("port_bytes", {"B", 1, 4096}));
  } else {
    to.unit_memory_bandwidth = reader.number("unit_memory_bandwidth", kBandwidth);
  }
}

void read_host(const Reader& reader, HostCosts& to) {
  const Field<HostCosts> fields[] = {
      {"api_call", &HostCosts::api_call_ns, kNanoseconds},
      {"submit", &HostCosts::submit_ns, kNanoseconds},
      {"launch", &HostCosts::launch_ns, kNanoseconds},
      {"wakeup", &HostCosts::wakeup_ns, kNanoseconds},
  };
  read_fields<HostCosts>(reader, fields, to);
}

void read_link(const Reader& reader, HostLink& to) {
  const Field<HostLink> fields[] = {
      {"shared_memory", &HostLink::shared_memory},
      {"bandwidth", &HostLink::bandwidth, kBandwidth},
      {"latency", &HostLink::latency_ns, kNanoseconds},
  };
  read_fields<HostLink>(reader, fields, to);
}

void read_power(const Reader& reader, Power& to) {
  const Field<Power> fields[] = {
      {"idle", &Power::idle_w, {"W", 0.001, 1e4}},
      {"busy", &Power::busy_w, {"W", 0.001, 1e4}},
      {"transfer", &Power::transfer_j_per_byte, {"J/B", 1e-13, 1e-6}},
  };
  read_fields<Power>(reader, fields, to);
  if (to.busy_w < to.idle_w) reader.fail("busy", "below idle, expected at least that");
}

void read_fabric(const Reader& reader, Fabric& to) {
  const Range count{"", 0, 1e8};
  const Field<Area> areas[] = {
      {"lut", &Area::lut, {"", 1, 1e8}}, {"ff", &Area::ff, {"", 1, 1e8}},
      {"bram36", &Area::bram36, count},  {"uram", &Area::uram, count},
      {"dsp", &Area::dsp, count},
  };
  const Field<Fabric> fields[] = {
      {"bitstream", &Fabric::bitstream_bytes, kSize},
      {"full_load", &Fabric::full_load_ns, {"ns", 1, 1e11}},
      {"partial_load", &Fabric::partial_load_ns, {"ns", 1, 1e11}},
  };
  read_fields<Fabric>(reader, fields, to, {"area"});
  read_fields<Area>(reader.section("area"), areas, to.area);
}

}  // namespace partita::profile
