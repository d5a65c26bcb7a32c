// What no emulated device has: shared virtual memory, pipes and the specialization constants of
// intermediate languages. Queries say so
// (device_info.cpp), and the calls are refused as OpenCL 3.0 asks for it.
#include "devices/layer/calls.h"
#include "devices/layer/launch.h"

namespace partita::layer {
namespace {

void* CL_API_CALL svm_alloc(cl_context, cl_svm_mem_flags, std::size_t, cl_uint) {
  return nullptr;
}
void CL_API_CALL svm_free(cl_context, void*) {}

cl_int CL_API_CALL svm_enqueue_free(cl_command_queue, cl_uint, void*[],
                                    void(CL_CALLBACK*)(cl_command_queue, cl_uint, void*[], void*),
                                    void*, cl_uint, const cl_event*, cl_event*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL svm_memcpy(cl_command_queue, cl_bool, void*, const void*, std::size_t, cl_uint,
                              const cl_event*, cl_event*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL svm_fill(cl_command_queue, void*, const void*, std::size_t, std::size_t, cl_uint,
                            const cl_event*, cl_event*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL svm_map(cl_command_queue, cl_bool, cl_map_flags, void*, std::size_t, cl_uint,
                           const cl_event*, cl_event*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL svm_unmap(cl_command_queue, void*, cl_uint, const cl_event*, cl_event*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL svm_migrate(cl_command_queue, cl_uint, const void**, const std::size_t*,
                               cl_mem_migration_flags, cl_uint, const cl_event*, cl_event*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL set_svm_arg(cl_kernel, cl_uint, const void*) {
  return CL_INVALID_OPERATION;
}
cl_int CL_API_CALL set_exec_info(cl_kernel, cl_kernel_exec_info, std::size_t, const void*) {
  return CL_INVALID_OPERATION;
}

cl_mem CL_API_CALL create_pipe(cl_context, cl_mem_flags, cl_uint, cl_uint,
                               const cl_pipe_properties*, cl_int* errcode_ret) {
  if (errcode_ret) *errcode_ret = CL_INVALID_OPERATION;
  return nullptr;
}

cl_int CL_API_CALL set_specialization_constant(cl_program program, cl_uint, std::size_t,
                                               const void*) {
  return program ? CL_INVALID_OPERATION : CL_INVALID_PROGRAM;
}

}  // namespace

void add_absent_calls(cl_icd_dispatch& table) {
  table.clSVMAlloc = svm_alloc;
  table.clSVMFree = svm_free;
  table.clEnqueueSVMFree = svm_enqueue_free;
  table.clEnqueueSVMMemcpy = svm_memcpy;
  table.clEnqueueSVMMemFill = svm_fill;
  table.clEnqueueSVMMap = svm_map;
  table.clEnqueueSVMUnmap = svm_unmap;
  table.clEnqueueSVMMigrateMem = svm_migrate;
  table.clSetKernelArgSVMPointer = set_svm_arg;
  table.clSetKernelExecInfo = set_exec_info;
  table.clCreatePipe = create_pipe;
  table.clSetProgramSpecializationConstant = set_specialization_constant;
}

}  // namespace partita::layer
