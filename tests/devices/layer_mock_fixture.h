// Shorthand for tests of the layer on the mock driver: a context, a queue and a kernel of one of
// dragonfly's devices, released at the end.
#ifndef PARTITA_TESTS_DEVICES_LAYER_MOCK_FIXTURE_H
#define PARTITA_TESTS_DEVICES_LAYER_MOCK_FIXTURE_H

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/layer/container.h"
#include "devices/work.h"
#include "tests/devices/layer_mock.h"

namespace partita::mock {

/// The layer's functions. Filled when the tests start: the layer is made after all static objects,
/// as a loader makes it.
inline cl_icd_dispatch cl;

struct LayerStart : testing::Environment {
  void SetUp() override { cl = layer(); }
};
inline const testing::Environment* const layer_start =
    testing::AddGlobalTestEnvironment(new LayerStart);

inline std::vector<cl_platform_id> platforms() {
  cl_uint count = 0;
  cl.clGetPlatformIDs(0, nullptr, &count);
  std::vector<cl_platform_id> list(count);
  cl.clGetPlatformIDs(count, list.data(), nullptr);
  return list;
}

/// The first device of the type on any platform.
inline cl_device_id device_of(cl_device_type type) {
  for (const cl_platform_id p : platforms()) {
    cl_device_id device = nullptr;
    if (cl.clGetDeviceIDs(p, type, 1, &device, nullptr) == CL_SUCCESS) return device;
  }
  return nullptr;
}

template <typename F>
F extension(const char* name) {
  return reinterpret_cast<F>(cl.clGetExtensionFunctionAddressForPlatform(platforms()[0], name));
}

inline std::string device_text(cl_device_id device, cl_device_info name) {
  char text[1024] = "";
  cl.clGetDeviceInfo(device, name, sizeof text, text, nullptr);
  return text;
}

/// Everything a command needs.
struct Rig {
  explicit Rig(cl_device_type type,
               cl_command_queue_properties properties = CL_QUEUE_PROFILING_ENABLE)
      : device(device_of(type)) {
    context = cl.clCreateContext(nullptr, 1, &device, nullptr, nullptr, nullptr);
    queue = cl.clCreateCommandQueue(context, device, properties, nullptr);
  }
  ~Rig() {
    if (kernel) cl.clReleaseKernel(kernel);
    if (program) cl.clReleaseProgram(program);
    if (buffer) cl.clReleaseMemObject(buffer);
    cl.clReleaseCommandQueue(queue);
    cl.clReleaseContext(context);
  }
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  cl_int build(const std::string& source, const char* options = "") {
    const char* text = source.c_str();
    cl_int error = CL_SUCCESS;
    program = cl.clCreateProgramWithSource(context, 1, &text, nullptr, &error);
    if (error != CL_SUCCESS) return error;
    return cl.clBuildProgram(program, 1, &device, options, nullptr, nullptr);
  }
  cl_int make_kernel(const char* name) {
    cl_int error = CL_SUCCESS;
    kernel = cl.clCreateKernel(program, name, &error);
    return error;
  }
  void make_buffer(std::size_t bytes) {
    buffer = cl.clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, nullptr);
  }
  cl_int launch(std::vector<std::size_t> global, std::vector<std::size_t> local,
                cl_event* event = nullptr, std::vector<cl_event> waits = {}) {
    return cl.clEnqueueNDRangeKernel(queue, kernel, static_cast<cl_uint>(global.size()), nullptr,
                                     global.data(), local.empty() ? nullptr : local.data(),
                                     static_cast<cl_uint>(waits.size()),
                                     waits.empty() ? nullptr : waits.data(), event);
  }

  cl_device_id device = nullptr;
  cl_context context = nullptr;
  cl_command_queue queue = nullptr;
  cl_program program = nullptr;
  cl_kernel kernel = nullptr;
  cl_mem buffer = nullptr;
};

inline cl_ulong time_of(cl_event event, cl_profiling_info name) {
  cl_ulong ns = 0;
  EXPECT_EQ(cl.clGetEventProfilingInfo(event, name, sizeof ns, &ns, nullptr), CL_SUCCESS);
  return ns;
}

/// A small container that fits the ZCU102.
inline layer::Container small_container() {
  layer::Container c;
  c.device = "zcu102";
  c.clock_mhz = 200;
  c.area.lut = 20000;
  c.build_options = "-DN=4";
  c.text = "__kernel void task(__global int* a) { a[0] = 1; }";
  layer::ContainerKernel k;
  k.name = "task";
  k.args = {{"a", "int*", "global"}};
  k.loops = {{"rows", 1, 20}};
  k.design.buffer_count = 1;
  k.design.buffers[0] = {1024, 8, 2, 2};
  k.area.lut = 20000;
  c.kernels.push_back(k);
  return c;
}

}  // namespace partita::mock

#endif  // PARTITA_TESTS_DEVICES_LAYER_MOCK_FIXTURE_H
