// A program's usual objects on an emulated device, under the real loader and on PoCL.
#ifndef PARTITA_TESTS_DEVICES_LAYER_EMULATED_H
#define PARTITA_TESTS_DEVICES_LAYER_EMULATED_H

#include <string>
#include <vector>

#include <CL/cl.h>
#include <gtest/gtest.h>

namespace partita {

inline cl_device_id device_of(cl_device_type type) {
  cl_platform_id platforms[8];
  cl_uint count = 0;
  clGetPlatformIDs(8, platforms, &count);
  for (cl_uint i = 0; i < count; ++i) {
    cl_device_id device = nullptr;
    if (clGetDeviceIDs(platforms[i], type, 1, &device, nullptr) == CL_SUCCESS) return device;
  }
  return nullptr;
}

class Emulated : public testing::TestWithParam<cl_device_type> {
 protected:
  explicit Emulated(cl_device_type type = CL_DEVICE_TYPE_GPU) : device_(device_of(type)) {}
  void SetUp() override {
    ASSERT_NE(device_, nullptr);
    context_ = clCreateContext(nullptr, 1, &device_, nullptr, nullptr, &error_);
    ASSERT_EQ(error_, CL_SUCCESS);
    queue_ = clCreateCommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE, &error_);
    ASSERT_EQ(error_, CL_SUCCESS);
  }
  void TearDown() override {
    if (kernel_) clReleaseKernel(kernel_);
    if (program_) clReleaseProgram(program_);
    if (queue_) clReleaseCommandQueue(queue_);
    if (context_) clReleaseContext(context_);
  }
  cl_int build(const char* source, const char* options = "") {
    program_ = clCreateProgramWithSource(context_, 1, &source, nullptr, &error_);
    if (!program_) return error_;
    return clBuildProgram(program_, 1, &device_, options, nullptr, nullptr);
  }
  std::string log() const {
    std::size_t bytes = 0;
    clGetProgramBuildInfo(program_, device_, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
    std::string text(bytes, '\0');
    clGetProgramBuildInfo(program_, device_, CL_PROGRAM_BUILD_LOG, bytes, text.data(), nullptr);
    return text;
  }
  cl_mem buffer(std::size_t bytes) {
    return clCreateBuffer(context_, CL_MEM_READ_WRITE, bytes, nullptr, &error_);
  }
  /// Runs "add" over n ints that start at 0 and returns them.
  std::vector<cl_int> run_add(cl_program program, std::size_t n, cl_int amount) {
    const cl_kernel kernel = clCreateKernel(program, "add", &error_);
    EXPECT_EQ(error_, CL_SUCCESS);
    std::vector<cl_int> data(n, 0);
    const cl_mem m = clCreateBuffer(context_, CL_MEM_COPY_HOST_PTR, n * 4, data.data(), &error_);
    clSetKernelArg(kernel, 0, sizeof m, &m);
    clSetKernelArg(kernel, 1, sizeof amount, &amount);
    EXPECT_EQ(clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &n, nullptr, 0, nullptr, nullptr),
              CL_SUCCESS);
    EXPECT_EQ(clEnqueueReadBuffer(queue_, m, CL_TRUE, 0, n * 4, data.data(), 0, nullptr, nullptr),
              CL_SUCCESS);
    clReleaseMemObject(m);
    clReleaseKernel(kernel);
    return data;
  }

  cl_device_id device_ = nullptr;
  cl_context context_ = nullptr;
  cl_command_queue queue_ = nullptr;
  cl_program program_ = nullptr;
  cl_kernel kernel_ = nullptr;
  cl_int error_ = CL_SUCCESS;
};

using EmulatedGpu = Emulated;

constexpr const char* kAdd =
    "__kernel void add(__global int* a, int n) { a[get_global_id(0)] += n; }";

}  // namespace partita

#endif  // PARTITA_TESTS_DEVICES_LAYER_EMULATED_H
