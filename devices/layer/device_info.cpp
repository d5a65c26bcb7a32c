#include "devices/layer/device_info.h"

#include <optional>

#include "devices/layer/version.h"
#include "devices/work.h"

namespace partita::layer {
namespace {

using Result = std::optional<cl_int>;  ///< empty: this group does not know the name

constexpr cl_version kV20 = CL_MAKE_VERSION(2, 0, 0);
constexpr cl_version kV21 = CL_MAKE_VERSION(2, 1, 0);
constexpr cl_version kV30 = CL_MAKE_VERSION(3, 0, 0);

cl_uint u32(std::uint64_t v) {
  return static_cast<cl_uint>(v > 0xffffffffull ? 0xffffffffull : v);
}
cl_bool yes(bool v) {
  return v ? CL_TRUE : CL_FALSE;
}

Result identity(const Device& d, cl_device_info name, const Answer& a) {
  switch (name) {
    case CL_DEVICE_TYPE:
      return a.put<cl_device_type>(profile::cl_type(d.profile.type));
    case CL_DEVICE_VENDOR_ID:
      return a.put(u32(d.cl.vendor_id));
    case CL_DEVICE_NAME:
      return a.put_text(d.cl.device_name);
    case CL_DEVICE_VENDOR:
      return a.put_text(d.cl.device_vendor);
    case CL_DRIVER_VERSION:
      return a.put_text(d.cl.driver_version);
    case CL_DEVICE_PROFILE:
      return a.put_text(d.cl.device_profile);
    case CL_DEVICE_VERSION:
      return a.put_text(d.cl.device_version);
    case CL_DEVICE_OPENCL_C_VERSION:
      return a.put_text(d.cl.c_version);
    case CL_DEVICE_EXTENSIONS:
      return a.put_text(d.cl.extensions);
    case CL_DEVICE_PLATFORM:
      return a.put(d.platform->handle());
    case CL_DEVICE_AVAILABLE:
      return a.put(yes(!d.fault.lost()));
    case CL_DEVICE_COMPILER_AVAILABLE:
      return a.put(yes(d.cl.compiler_available || (d.is_fpga() && state().allow_source)));
    case CL_DEVICE_LINKER_AVAILABLE:
      return a.put(yes(d.cl.linker_available || (d.is_fpga() && state().allow_source)));
    case CL_DEVICE_BUILT_IN_KERNELS:
      return a.put_text("");
    case CL_DEVICE_EXECUTION_CAPABILITIES:
      return a.put<cl_device_exec_capabilities>(
          CL_EXEC_KERNEL |
          (d.profile.type == profile::DeviceType::cpu ? CL_EXEC_NATIVE_KERNEL : 0));
    case CL_DEVICE_QUEUE_PROPERTIES:
      return a.put<cl_command_queue_properties>(
          CL_QUEUE_PROFILING_ENABLE |
          (d.cl.out_of_order_queues ? CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE : 0));
    case kDeviceNode:
      return a.put_text(state().machine.nodes[d.machine.node].name);
    case kDeviceProfile:
      return a.put_text(d.profile.id);
    default:
      return {};
  }
}

Result compute_limits(const Device& d, cl_device_info name, const Answer& a) {
  switch (name) {
    case CL_DEVICE_MAX_COMPUTE_UNITS:
      return a.put(u32(d.cl.max_compute_units));
    case CL_DEVICE_MAX_CLOCK_FREQUENCY:
      return a.put(u32(d.cl.clock_mhz));
    case CL_DEVICE_ADDRESS_BITS:
      return a.put(u32(d.cl.address_bits));
    case CL_DEVICE_MAX_WORK_ITEM_DIMENSIONS:
      return a.put<cl_uint>(3);
    case CL_DEVICE_MAX_WORK_GROUP_SIZE:
      return a.put<std::size_t>(d.cl.max_work_group_size);
    case CL_DEVICE_MAX_WORK_ITEM_SIZES: {
      const std::array<std::size_t, 3> sizes{
          d.cl.max_work_item_sizes[0], d.cl.max_work_item_sizes[1], d.cl.max_work_item_sizes[2]};
      return a.put(sizes);
    }
    case CL_DEVICE_MAX_PARAMETER_SIZE:
      return a.put<std::size_t>(d.cl.max_parameter_size);
    case CL_DEVICE_PROFILING_TIMER_RESOLUTION:
      return a.put<std::size_t>(d.cl.profiling_timer_resolution);
    case CL_DEVICE_PRINTF_BUFFER_SIZE:
      return a.put<std::size_t>(d.cl.printf_buffer_size);
    case CL_DEVICE_ENDIAN_LITTLE:
      return a.put(yes(d.cl.little_endian));
    case CL_DEVICE_SINGLE_FP_CONFIG:
      return a.put<cl_device_fp_config>(d.cl.single_fp_config);
    case CL_DEVICE_DOUBLE_FP_CONFIG:
      return a.put<cl_device_fp_config>(d.cl.double_fp_config);
    case CL_DEVICE_HALF_FP_CONFIG:
      return a.put<cl_device_fp_config>(0);
    case CL_DEVICE_PREFERRED_INTEROP_USER_SYNC:
      return a.put<cl_bool>(CL_TRUE);
    default:
      return {};
  }
}

/// Preferred and native vector widths; the queries' numbers are two runs of consecutive values,
/// with half's aside.
Result vector_widths(const Device& d, cl_device_info name, const Answer& a) {
  const auto& preferred = d.cl.preferred_vector_widths;
  const auto& native = d.cl.native_vector_widths;
  switch (name) {
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_CHAR:
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_SHORT:
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_INT:
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_LONG:
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_FLOAT:
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_DOUBLE:
      return a.put<cl_uint>(preferred[name - CL_DEVICE_PREFERRED_VECTOR_WIDTH_CHAR]);
    case CL_DEVICE_PREFERRED_VECTOR_WIDTH_HALF:
      return a.put<cl_uint>(preferred[6]);
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_CHAR:
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_SHORT:
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_INT:
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_LONG:
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT:
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_DOUBLE:
      return a.put<cl_uint>(native[name - CL_DEVICE_NATIVE_VECTOR_WIDTH_CHAR]);
    case CL_DEVICE_NATIVE_VECTOR_WIDTH_HALF:
      return a.put<cl_uint>(native[6]);
    default:
      return {};
  }
}

Result memory_limits(const Device& d, cl_device_info name, const Answer& a) {
  switch (name) {
    case CL_DEVICE_GLOBAL_MEM_SIZE:
      return a.put<cl_ulong>(d.cl.global_mem_size);
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
      return a.put<cl_ulong>(d.cl.max_mem_alloc_size);
    case CL_DEVICE_GLOBAL_MEM_CACHE_TYPE:
      return a.put<cl_device_mem_cache_type>(d.cl.global_mem_cache_size ? CL_READ_WRITE_CACHE
                                                                        : CL_NONE);
    case CL_DEVICE_GLOBAL_MEM_CACHE_SIZE:
      return a.put<cl_ulong>(d.cl.global_mem_cache_size);
    case CL_DEVICE_GLOBAL_MEM_CACHELINE_SIZE:
      return a.put(u32(d.cl.global_mem_cacheline_size));
    case CL_DEVICE_MAX_CONSTANT_BUFFER_SIZE:
      return a.put<cl_ulong>(d.cl.max_constant_buffer_size);
    case CL_DEVICE_MAX_CONSTANT_ARGS:
      return a.put(u32(d.cl.max_constant_args));
    case CL_DEVICE_LOCAL_MEM_TYPE:
      return a.put<cl_device_local_mem_type>(d.cl.local_mem_dedicated ? CL_LOCAL : CL_GLOBAL);
    case CL_DEVICE_LOCAL_MEM_SIZE:
      return a.put<cl_ulong>(d.cl.local_mem_size);
    case CL_DEVICE_ERROR_CORRECTION_SUPPORT:
      return a.put(yes(d.cl.error_correction));
    case CL_DEVICE_HOST_UNIFIED_MEMORY:
      return a.put(yes(d.cl.host_unified_memory));
    case CL_DEVICE_MEM_BASE_ADDR_ALIGN:
      return a.put(u32(d.cl.mem_base_addr_align_bits));
    case CL_DEVICE_MIN_DATA_TYPE_ALIGN_SIZE:
      return a.put(u32(d.cl.min_data_type_align_size));
    default:
      return {};
  }
}

Result image_limits(const Device& d, cl_device_info name, const Answer& a) {
  switch (name) {
    case CL_DEVICE_IMAGE_SUPPORT:
      return a.put(yes(d.cl.image_support));
    case CL_DEVICE_MAX_READ_IMAGE_ARGS:
      return a.put(u32(d.cl.max_read_image_args));
    case CL_DEVICE_MAX_WRITE_IMAGE_ARGS:
      return a.put(u32(d.cl.max_write_image_args));
    case CL_DEVICE_MAX_SAMPLERS:
      return a.put(u32(d.cl.max_samplers));
    case CL_DEVICE_IMAGE2D_MAX_WIDTH:
      return a.put<std::size_t>(d.cl.image2d_max[0]);
    case CL_DEVICE_IMAGE2D_MAX_HEIGHT:
      return a.put<std::size_t>(d.cl.image2d_max[1]);
    case CL_DEVICE_IMAGE3D_MAX_WIDTH:
      return a.put<std::size_t>(d.cl.image3d_max[0]);
    case CL_DEVICE_IMAGE3D_MAX_HEIGHT:
      return a.put<std::size_t>(d.cl.image3d_max[1]);
    case CL_DEVICE_IMAGE3D_MAX_DEPTH:
      return a.put<std::size_t>(d.cl.image3d_max[2]);
    case CL_DEVICE_IMAGE_MAX_BUFFER_SIZE:
      return a.put<std::size_t>(d.cl.image_max_buffer_size);
    case CL_DEVICE_IMAGE_MAX_ARRAY_SIZE:
      return a.put<std::size_t>(d.cl.image_max_array_size);
    default:
      return {};
  }
}

Result partition(const Device&, cl_device_info name, const Answer& a) {
  switch (name) {
    case CL_DEVICE_PARENT_DEVICE:
      return a.put<cl_device_id>(nullptr);
    case CL_DEVICE_REFERENCE_COUNT:
      return a.put<cl_uint>(1);
    case CL_DEVICE_PARTITION_MAX_SUB_DEVICES:
      return a.put<cl_uint>(1);
    case CL_DEVICE_PARTITION_PROPERTIES:
    case CL_DEVICE_PARTITION_TYPE:
      return a.put<cl_device_partition_property>(0);
    case CL_DEVICE_PARTITION_AFFINITY_DOMAIN:
      return a.put<cl_device_affinity_domain>(0);
    default:
      return {};
  }
}

/// Of OpenCL 2.x, all of it optional in 3.0: shared virtual memory, pipes, device queues and
/// sub-groups are what PoCL's CPU device and the emulated runtimes do not have in common.
Result from_2_0(const Device& d, cl_device_info name, const Answer& a) {
  if (d.version < kV20) return {};
  switch (name) {
    case CL_DEVICE_SVM_CAPABILITIES:
      return a.put<cl_device_svm_capabilities>(0);
    case CL_DEVICE_QUEUE_ON_DEVICE_PROPERTIES:
      return a.put<cl_command_queue_properties>(0);
    case CL_DEVICE_MAX_GLOBAL_VARIABLE_SIZE:
    case CL_DEVICE_GLOBAL_VARIABLE_PREFERRED_TOTAL_SIZE:
      return a.put<std::size_t>(0);
    case CL_DEVICE_IMAGE_PITCH_ALIGNMENT:
    case CL_DEVICE_IMAGE_BASE_ADDRESS_ALIGNMENT:
    case CL_DEVICE_MAX_READ_WRITE_IMAGE_ARGS:
    case CL_DEVICE_QUEUE_ON_DEVICE_PREFERRED_SIZE:
    case CL_DEVICE_QUEUE_ON_DEVICE_MAX_SIZE:
    case CL_DEVICE_MAX_ON_DEVICE_QUEUES:
    case CL_DEVICE_MAX_ON_DEVICE_EVENTS:
    case CL_DEVICE_MAX_PIPE_ARGS:
    case CL_DEVICE_PIPE_MAX_ACTIVE_RESERVATIONS:
    case CL_DEVICE_PIPE_MAX_PACKET_SIZE:
    case CL_DEVICE_PREFERRED_PLATFORM_ATOMIC_ALIGNMENT:
    case CL_DEVICE_PREFERRED_GLOBAL_ATOMIC_ALIGNMENT:
    case CL_DEVICE_PREFERRED_LOCAL_ATOMIC_ALIGNMENT:
      return a.put<cl_uint>(0);
    default:
      break;
  }
  if (d.version < kV21) return {};
  switch (name) {
    case CL_DEVICE_IL_VERSION:
      return a.put_text("");
    case CL_DEVICE_MAX_NUM_SUB_GROUPS:
      return a.put<cl_uint>(0);
    case CL_DEVICE_SUB_GROUP_INDEPENDENT_FORWARD_PROGRESS:
      return a.put<cl_bool>(CL_FALSE);
    default:
      return {};
  }
}

std::vector<cl_name_version> named(const std::vector<cl_version>& versions) {
  std::vector<cl_name_version> list;
  for (const cl_version v : versions) list.push_back(name_version("OpenCL C", v));
  return list;
}

std::vector<cl_name_version> named(const std::vector<std::string>& features) {
  std::vector<cl_name_version> list;
  for (const std::string& f : features) list.push_back(name_version(f, kV30));
  return list;
}

Result from_3_0(const Device& d, cl_device_info name, const Answer& a) {
  if (d.version < kV30) return {};
  switch (name) {
    case CL_DEVICE_NUMERIC_VERSION:
      return a.put(d.version);
    case CL_DEVICE_EXTENSIONS_WITH_VERSION:
      return a.put_list(with_versions(d.extensions));
    case CL_DEVICE_ILS_WITH_VERSION:
    case CL_DEVICE_BUILT_IN_KERNELS_WITH_VERSION:
      return a.put_list(std::vector<cl_name_version>{});
    case CL_DEVICE_OPENCL_C_ALL_VERSIONS:
      return a.put_list(named(c_versions(d)));
    case CL_DEVICE_OPENCL_C_FEATURES:
      return a.put_list(named(c_features(d)));
    case CL_DEVICE_OPENCL_C_NUMERIC_VERSION_KHR:
      return a.put(d.c_version);
    case CL_DEVICE_ATOMIC_MEMORY_CAPABILITIES:
      return a.put<cl_device_atomic_capabilities>(CL_DEVICE_ATOMIC_ORDER_RELAXED |
                                                  CL_DEVICE_ATOMIC_SCOPE_WORK_GROUP);
    case CL_DEVICE_ATOMIC_FENCE_CAPABILITIES:
      return a.put<cl_device_atomic_capabilities>(CL_DEVICE_ATOMIC_ORDER_RELAXED |
                                                  CL_DEVICE_ATOMIC_ORDER_ACQ_REL |
                                                  CL_DEVICE_ATOMIC_SCOPE_WORK_GROUP);
    case CL_DEVICE_DEVICE_ENQUEUE_CAPABILITIES:
      return a.put<cl_device_device_enqueue_capabilities>(0);
    case CL_DEVICE_NON_UNIFORM_WORK_GROUP_SUPPORT:
    case CL_DEVICE_WORK_GROUP_COLLECTIVE_FUNCTIONS_SUPPORT:
    case CL_DEVICE_GENERIC_ADDRESS_SPACE_SUPPORT:
    case CL_DEVICE_PIPE_SUPPORT:
      return a.put<cl_bool>(CL_FALSE);
    case CL_DEVICE_PREFERRED_WORK_GROUP_SIZE_MULTIPLE:
      return a.put<std::size_t>(d.cl.preferred_work_group_multiple);
    case CL_DEVICE_LATEST_CONFORMANCE_VERSION_PASSED:
      return a.put_text("v0000-01-01-00");
    default:
      return {};
  }
}

}  // namespace

std::vector<cl_version> c_versions(const Device& d) {
  std::vector<cl_version> versions;
  constexpr cl_version kAll[] = {CL_MAKE_VERSION(1, 0, 0), CL_MAKE_VERSION(1, 1, 0),
                                 CL_MAKE_VERSION(1, 2, 0), kV20, kV30};
  for (const cl_version v : kAll) {
    if (v <= d.c_version || (v == kV30 && d.version >= kV30)) versions.push_back(v);
  }
  return versions;
}

std::vector<std::string> c_features(const Device& d) {
  std::vector<std::string> features{"__opencl_c_int64"};
  if (d.cl.doubles()) features.push_back("__opencl_c_fp64");
  if (d.cl.image_support) features.push_back("__opencl_c_images");
  if (d.cl.image_support && d.has("cl_khr_3d_image_writes")) {
    features.push_back("__opencl_c_3d_image_writes");
  }
  return features;
}

cl_int device_info(const Device& device, cl_device_info name, const Answer& answer) {
  constexpr Result (*kGroups[])(const Device&, cl_device_info, const Answer&) = {
      identity,     compute_limits, vector_widths, memory_limits,
      image_limits, partition,      from_2_0,      from_3_0};
  for (const auto group : kGroups) {
    if (const Result result = group(device, name, answer)) return *result;
  }
  return CL_INVALID_VALUE;
}

}  // namespace partita::layer
