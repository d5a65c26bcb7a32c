// Estimates for kernels that declare no Work, seen through the record: counts that can be told
// from the code are exact, unknown loops turn 16 times.
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/timeline/record.h"
#include "devices/work.h"

namespace partita {
namespace {

constexpr std::size_t kItems = 4096;

cl_program built(cl_context context, const char* source) {
  const cl_program program = clCreateProgramWithSource(context, 1, &source, nullptr, nullptr);
  EXPECT_EQ(clBuildProgram(program, 0, nullptr, "", nullptr, nullptr), CL_SUCCESS);
  return program;
}

/// The source, linked with a function that it calls.
cl_program linked(cl_context context, const char* source) {
  const char* library =
      "float power(float s) { for (int k = 0; k < 100; ++k) s = fma(s, s, 1.5f); return s; }";
  cl_program parts[2] = {clCreateProgramWithSource(context, 1, &source, nullptr, nullptr),
                         clCreateProgramWithSource(context, 1, &library, nullptr, nullptr)};
  for (const cl_program p : parts) {
    EXPECT_EQ(clCompileProgram(p, 0, nullptr, "", 0, nullptr, nullptr, nullptr, nullptr),
              CL_SUCCESS);
  }
  const cl_program program =
      clLinkProgram(context, 0, nullptr, "", 2, parts, nullptr, nullptr, nullptr);
  EXPECT_NE(program, nullptr);
  for (const cl_program p : parts) clReleaseProgram(p);
  return program;
}

/// Launches every kernel of `source` once on the emulated GPU, each with two buffers of kItems
/// floats, 256 bytes of local memory and an int, and returns the Work that was charged, by order.
std::vector<Work> charged(const char* source, const std::vector<const char*>& kernels,
                          cl_program (*make)(cl_context, const char*) = built) {
  cl_platform_id platforms[8];
  cl_uint count = 0;
  clGetPlatformIDs(8, platforms, &count);
  cl_device_id device = nullptr;
  cl_platform_id platform = nullptr;
  for (cl_uint i = 0; i < count && !device; ++i) {
    platform = platforms[i];
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_GPU, 1, &device, nullptr) != CL_SUCCESS) {
      device = nullptr;
    }
  }
  const cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, nullptr);
  const cl_command_queue queue = clCreateCommandQueue(context, device, 0, nullptr);
  const cl_program program = make(context, source);
  cl_mem buffers[2];
  for (cl_mem& b : buffers) {
    b = clCreateBuffer(context, CL_MEM_READ_WRITE, kItems * sizeof(float), nullptr, nullptr);
  }
  const cl_int n = 3;
  for (const char* name : kernels) {
    const cl_kernel kernel = clCreateKernel(program, name, nullptr);
    clSetKernelArg(kernel, 0, sizeof(cl_mem), &buffers[0]);
    clSetKernelArg(kernel, 1, sizeof(cl_mem), &buffers[1]);
    clSetKernelArg(kernel, 2, 256, nullptr);
    clSetKernelArg(kernel, 3, sizeof n, &n);
    const std::size_t local = 64;
    EXPECT_EQ(
        clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &kItems, &local, 0, nullptr, nullptr),
        CL_SUCCESS);
    clReleaseKernel(kernel);
  }
  clFinish(queue);
  const std::string path = testing::TempDir() + "partita_estimate.record";
  const auto save = reinterpret_cast<ExportRecordFn>(
      clGetExtensionFunctionAddressForPlatform(platform, kExportRecord));
  EXPECT_EQ(save(path.c_str()), CL_SUCCESS);
  const timeline::Record record = timeline::load_record(path);
  std::remove(path.c_str());
  std::vector<Work> works;
  for (const timeline::RecordedCommand& c : record.commands) {
    if (c.work != timeline::kNone) works.push_back(record.works[c.work]);
  }
  EXPECT_GE(works.size(), kernels.size());
  works.erase(works.begin(), works.end() - static_cast<std::ptrdiff_t>(kernels.size()));
  for (const cl_mem b : buffers) clReleaseMemObject(b);
  clReleaseProgram(program);
  clReleaseCommandQueue(queue);
  clReleaseContext(context);
  return works;
}

TEST(Estimate, CountsWhatTheCodeSays) {
  const char* source = R"(
    #define ARGS __global float* a, __global const float* b, __local float* l, int n
    __kernel void fused(ARGS) {
      int i = get_global_id(0);
      float s = b[i];
      for (int k = 0; k < 100; ++k) s = fma(s, s, 1.5f);
      a[i] = s;
    }
    __kernel void unknown(ARGS) {
      int i = get_global_id(0);
      float s = 0;
      for (int k = 0; k < n; ++k) s += b[(i + k) & 4095];
      a[i] = s;
    }
    __kernel void shared(ARGS) {
      int i = get_local_id(0);
      l[i] = b[get_global_id(0)];
      barrier(CLK_LOCAL_MEM_FENCE);
      a[get_global_id(0)] = l[63 - i];
    }
    __kernel void indirect(ARGS) {
      int i = get_global_id(0);
      a[i] = b[((int)b[i]) & 4095];
    })";
  const std::vector<Work> works = charged(source, {"fused", "unknown", "shared", "indirect"});
  ASSERT_EQ(works.size(), 4u);
  for (const Work& w : works) EXPECT_EQ(w.estimated, 1u);
  const Work &fused = works[0], &unknown = works[1], &shared = works[2], &indirect = works[3];
  EXPECT_EQ(fused[OpClass::float_fma], 100 * kItems);
  EXPECT_EQ(fused.read_issued, 4 * kItems);
  EXPECT_EQ(fused.written_issued, 4 * kItems);
  EXPECT_EQ(fused[OpClass::int_add], 0u) << "addresses and loop control are left out";
  EXPECT_EQ(fused.kind, WorkKind::stream);
  EXPECT_EQ(unknown[OpClass::float_add], 16 * kItems);
  EXPECT_EQ(unknown.read_issued, 16 * 4 * kItems);
  EXPECT_LE(unknown.read_unique, 2 * 4 * kItems) << "no more than the buffers hold";
  EXPECT_EQ(shared.local_bytes, 2 * 4 * kItems);
  EXPECT_EQ(shared.read_issued, 4 * kItems);
  EXPECT_EQ(indirect.kind, WorkKind::gather);
}

TEST(Estimate, ReadsTheCodeOfALinkedProgram) {
  const char* source = R"(
    float power(float s);
    __kernel void powers(__global float* a, __global const float* b, __local float* l, int n) {
      a[get_global_id(0)] = power(b[get_global_id(0)]);
    })";
  const std::vector<Work> works = charged(source, {"powers"}, linked);
  ASSERT_EQ(works.size(), 1u);
  EXPECT_EQ(works[0][OpClass::float_fma], 100 * kItems);
  EXPECT_EQ(works[0].written_issued, 4 * kItems);
}

}  // namespace
}  // namespace partita
