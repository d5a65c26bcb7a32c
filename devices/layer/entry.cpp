// The two functions that the ICD loader looks for in a layer.
#include <cstdlib>

#include <CL/cl_layer.h>

#include "devices/layer/answer.h"
#include "devices/layer/calls.h"
#include "devices/layer/handles.h"
#include "devices/layer/record.h"
#include "devices/layer/state.h"

namespace partita::layer {
namespace {

cl_icd_dispatch layer_table{};

void build_table() {
  layer_table = target();
  add_platform_calls(layer_table);
  add_device_calls(layer_table);
  add_context_calls(layer_table);
  add_queue_calls(layer_table);
  add_program_calls(layer_table);
  add_program_build_calls(layer_table);
  add_program_info_calls(layer_table);
  add_kernel_calls(layer_table);
  add_kernel_info_calls(layer_table);
  add_launch_calls(layer_table);
  add_memory_calls(layer_table);
  add_image_calls(layer_table);
  add_sampler_calls(layer_table);
  add_absent_calls(layer_table);
  add_transfer_calls(layer_table);
  add_image_transfer_calls(layer_table);
  add_copy_calls(layer_table);
  add_map_calls(layer_table);
  add_sync_calls(layer_table);
  add_event_calls(layer_table);
  add_callback_calls(layer_table);
  add_extension_calls(layer_table);
  guard_handles(layer_table);
}

}  // namespace
}  // namespace partita::layer

#define PARTITA_EXPORT extern "C" __attribute__((visibility("default")))

PARTITA_EXPORT CL_API_ENTRY cl_int CL_API_CALL clGetLayerInfo(cl_layer_info name, size_t size,
                                                              void* value, size_t* size_ret) {
  const partita::layer::Answer answer(size, value, size_ret);
  switch (name) {
    case CL_LAYER_API_VERSION:
      return answer.put<cl_layer_api_version>(CL_LAYER_API_VERSION_100);
    case CL_LAYER_NAME:
      return answer.put_text("partita");
    default:
      return CL_INVALID_VALUE;
  }
}

PARTITA_EXPORT CL_API_ENTRY cl_int CL_API_CALL
clInitLayer(cl_uint num_entries, const cl_icd_dispatch* target_dispatch, cl_uint* num_entries_ret,
            const cl_icd_dispatch** layer_dispatch_ret) {
  using namespace partita::layer;
  constexpr cl_uint kEntries = sizeof(cl_icd_dispatch) / sizeof(void*);
  if (!target_dispatch || !num_entries_ret || !layer_dispatch_ret) return CL_INVALID_VALUE;
  const char* machine = std::getenv("PARTITA_MACHINE");
  if (!machine || !*machine) {
    *num_entries_ret = num_entries;
    *layer_dispatch_ret = target_dispatch;
    return CL_SUCCESS;
  }
  if (num_entries < kEntries) {
    say("the OpenCL loader knows " + std::to_string(num_entries) + " functions, expected " +
        std::to_string(kEntries) + " (OpenCL 3.0)");
    return CL_INVALID_VALUE;
  }
  set_target(*target_dispatch, num_entries);
  read_environment();
  build_table();
  *num_entries_ret = kEntries;
  *layer_dispatch_ret = &layer_table;
  return CL_SUCCESS;
}
