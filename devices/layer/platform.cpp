// clGetPlatformIDs, clGetPlatformInfo, clUnloadPlatformCompiler: one platform for each vendor of
// the machine; the driver's own platform is hidden.
#include "devices/layer/answer.h"
#include "devices/layer/call.h"
#include "devices/layer/calls.h"
#include "devices/layer/version.h"

#ifndef CL_PLATFORM_NOT_FOUND_KHR
#define CL_PLATFORM_NOT_FOUND_KHR -1001
#endif

namespace partita::layer {
namespace {

cl_int CL_API_CALL get_platform_ids(cl_uint num_entries, cl_platform_id* platforms,
                                    cl_uint* num_platforms) {
  return guarded([&]() -> cl_int {
    if ((!platforms && !num_platforms) || (platforms && num_entries == 0)) return CL_INVALID_VALUE;
    if (!open_machine()) {
      if (num_platforms) *num_platforms = 0;
      return CL_PLATFORM_NOT_FOUND_KHR;
    }
    const auto& all = state().platforms;
    for (cl_uint i = 0; platforms && i < num_entries && i < all.size(); ++i) {
      platforms[i] = all[i]->handle();
    }
    if (num_platforms) *num_platforms = static_cast<cl_uint>(all.size());
    return CL_SUCCESS;
  });
}

cl_int CL_API_CALL get_platform_info(cl_platform_id handle, cl_platform_info name, std::size_t size,
                                     void* value, std::size_t* size_ret) {
  return guarded([&]() -> cl_int {
    // Without a platform the first one answers, as PoCL and NVIDIA do.
    const Platform* platform =
        handle ? find_platform(handle) : (open_machine() ? state().platforms[0].get() : nullptr);
    if (!platform) return CL_INVALID_PLATFORM;
    const Answer answer(size, value, size_ret);
    const bool is_3_0 = CL_VERSION_MAJOR(platform->version) >= 3;
    switch (name) {
      case CL_PLATFORM_PROFILE:
        return answer.put_text(platform->cl->platform_profile);
      case CL_PLATFORM_VERSION:
        return answer.put_text(platform->cl->platform_version);
      case CL_PLATFORM_NAME:
        return answer.put_text(platform->cl->platform_name);
      case CL_PLATFORM_VENDOR:
        return answer.put_text(platform->cl->platform_vendor);
      case CL_PLATFORM_EXTENSIONS:
        return answer.put_text(platform->cl->platform_extensions);
      case CL_PLATFORM_ICD_SUFFIX_KHR:
        return answer.put_text(platform->cl->icd_suffix);
      case CL_PLATFORM_HOST_TIMER_RESOLUTION:  // 0: no synchronised timers
        return platform->version >= CL_MAKE_VERSION(2, 1, 0) ? answer.put<cl_ulong>(0)
                                                             : CL_INVALID_VALUE;
      case CL_PLATFORM_NUMERIC_VERSION:
        return is_3_0 ? answer.put(platform->version) : CL_INVALID_VALUE;
      case CL_PLATFORM_EXTENSIONS_WITH_VERSION:
        return is_3_0
                   ? answer.put_list(with_versions(split_words(platform->cl->platform_extensions)))
                   : CL_INVALID_VALUE;
      default:
        return CL_INVALID_VALUE;
    }
  });
}

cl_int CL_API_CALL unload_platform_compiler(cl_platform_id handle) {
  return guarded([&]() -> cl_int {
    if (!find_platform(handle)) return CL_INVALID_PLATFORM;
    return target().clUnloadPlatformCompiler(state().real_platform);
  });
}

}  // namespace

void add_platform_calls(cl_icd_dispatch& table) {
  table.clGetPlatformIDs = get_platform_ids;
  table.clGetPlatformInfo = get_platform_info;
  table.clUnloadPlatformCompiler = unload_platform_compiler;
}

}  // namespace partita::layer
