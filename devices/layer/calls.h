// The groups of entry points. Each puts its overrides into a copy of the target's dispatch table;
// what no group overrides goes straight to the driver.
#ifndef PARTITA_DEVICES_LAYER_CALLS_H
#define PARTITA_DEVICES_LAYER_CALLS_H

#include <CL/cl_icd.h>

namespace partita::layer {

void add_platform_calls(cl_icd_dispatch& table);
void add_device_calls(cl_icd_dispatch& table);
void add_context_calls(cl_icd_dispatch& table);
void add_queue_calls(cl_icd_dispatch& table);
void add_program_calls(cl_icd_dispatch& table);
void add_program_build_calls(cl_icd_dispatch& table);
void add_program_info_calls(cl_icd_dispatch& table);
void add_kernel_calls(cl_icd_dispatch& table);
void add_kernel_info_calls(cl_icd_dispatch& table);
void add_launch_calls(cl_icd_dispatch& table);
void add_memory_calls(cl_icd_dispatch& table);
void add_image_calls(cl_icd_dispatch& table);
void add_sampler_calls(cl_icd_dispatch& table);
void add_absent_calls(cl_icd_dispatch& table);
void add_transfer_calls(cl_icd_dispatch& table);
void add_image_transfer_calls(cl_icd_dispatch& table);
void add_copy_calls(cl_icd_dispatch& table);
void add_map_calls(cl_icd_dispatch& table);
void add_sync_calls(cl_icd_dispatch& table);
void add_event_calls(cl_icd_dispatch& table);
void add_callback_calls(cl_icd_dispatch& table);
void add_extension_calls(cl_icd_dispatch& table);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_CALLS_H
