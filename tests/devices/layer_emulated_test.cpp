// The layer under the real loader, on PoCL: kernels really run, limits are the devices', and the
// behaviours that OpenCL's conformance tests look at hold on the emulated GPU.
#include "tests/devices/layer_emulated.h"

#include <atomic>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/layer/container.h"
#include "devices/work.h"

namespace partita {
namespace {

TEST_F(EmulatedGpu, KernelsReallyRun) {
  ASSERT_EQ(build(kAdd), CL_SUCCESS) << log();
  EXPECT_EQ(run_add(program_, 1000, 7), std::vector<cl_int>(1000, 7));
}

TEST_F(EmulatedGpu, TheCompilerSeesTheDevice) {
  EXPECT_EQ(build("#if __OPENCL_C_VERSION__ != 120 || __OPENCL_VERSION__ != 300\n#error version\n"
                  "#endif\n#ifdef __opencl_c_generic_address_space\n#error generic\n#endif\n"
                  "#ifndef cl_nv_pragma_unroll\n#error nv\n#endif\n"
                  "#ifdef cl_khr_command_buffer\n#error pocl\n#endif\n"
                  "__kernel void k(__global double* a) { a[0] = 1.0; }"),
            CL_SUCCESS)
      << log();
  EXPECT_TRUE(std::string(log().c_str()).empty()) << log();
}

TEST_F(EmulatedGpu, MessagesKeepTheirLines) {
  EXPECT_EQ(build("__kernel void k() {}\n\nthis is wrong\n"), CL_BUILD_PROGRAM_FAILURE);
  EXPECT_NE(log().find(":3:"), std::string::npos) << log();
}

TEST_F(EmulatedGpu, LocalMemoryAndGroupsAreLimited) {
  ASSERT_EQ(build("__kernel void k(__global int* a) { __local int s[12288 - 64];"
                  " s[get_local_id(0)] = 1; barrier(CLK_LOCAL_MEM_FENCE); a[0] = s[0]; }\n"
                  "__kernel void big(__global int* a) { __local int s[12289];"
                  " s[get_local_id(0)] = 1; barrier(CLK_LOCAL_MEM_FENCE); a[0] = s[0]; }"),
            CL_SUCCESS);
  const cl_mem m = buffer(64);
  const std::size_t sixteen = 16, many = 4096;
  for (const auto& [name, expected] :
       {std::pair{"k", CL_SUCCESS}, std::pair{"big", CL_OUT_OF_RESOURCES}}) {
    const cl_kernel kernel = clCreateKernel(program_, name, &error_);
    clSetKernelArg(kernel, 0, sizeof m, &m);
    EXPECT_EQ(
        clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &sixteen, &sixteen, 0, nullptr, nullptr),
        expected);
    EXPECT_NE(clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &many, &many, 0, nullptr, nullptr),
              CL_SUCCESS);
    clReleaseKernel(kernel);
  }
  clFinish(queue_);
  clReleaseMemObject(m);
}

TEST_F(EmulatedGpu, ProgramsMakeTheRoundTripThroughTheirBinary) {
  ASSERT_EQ(build(kAdd), CL_SUCCESS);
  std::size_t size = 0;
  ASSERT_EQ(clGetProgramInfo(program_, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr),
            CL_SUCCESS);
  std::vector<unsigned char> bytes(size);
  unsigned char* pointer = bytes.data();
  ASSERT_EQ(clGetProgramInfo(program_, CL_PROGRAM_BINARIES, sizeof pointer, &pointer, nullptr),
            CL_SUCCESS);
  const unsigned char* binary = bytes.data();
  cl_int status = -1;
  const cl_program again =
      clCreateProgramWithBinary(context_, 1, &device_, &size, &binary, &status, &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(status, CL_SUCCESS);
  ASSERT_EQ(clBuildProgram(again, 0, nullptr, "", nullptr, nullptr), CL_SUCCESS);
  EXPECT_EQ(run_add(again, 64, 3), std::vector<cl_int>(64, 3));
  clReleaseProgram(again);
}

TEST_F(EmulatedGpu, CompilesAndLinksWithHeaders) {
  const char* header_text = "int amount(int n);";
  const char* main_text =
      "#include \"amount.h\"\n__kernel void add(__global int* a, int n)"
      " { a[get_global_id(0)] += amount(n); }";
  const char* library_text = "int amount(int n) { return 2 * n; }";
  const cl_program header = clCreateProgramWithSource(context_, 1, &header_text, nullptr, &error_);
  cl_program parts[2] = {clCreateProgramWithSource(context_, 1, &main_text, nullptr, &error_),
                         clCreateProgramWithSource(context_, 1, &library_text, nullptr, &error_)};
  const char* name = "amount.h";
  ASSERT_EQ(clCompileProgram(parts[0], 1, &device_, "", 1, &header, &name, nullptr, nullptr),
            CL_SUCCESS);
  ASSERT_EQ(clCompileProgram(parts[1], 0, nullptr, "", 0, nullptr, nullptr, nullptr, nullptr),
            CL_SUCCESS);
  const cl_program linked =
      clLinkProgram(context_, 1, &device_, "", 2, parts, nullptr, nullptr, &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(run_add(linked, 64, 3), std::vector<cl_int>(64, 6));
  for (const cl_program p : {header, parts[0], parts[1], linked}) clReleaseProgram(p);
}

TEST_F(EmulatedGpu, ArgumentInfoIsForThoseWhoAskForIt) {
  for (const auto& [options, expected] : {std::pair{"", CL_KERNEL_ARG_INFO_NOT_AVAILABLE},
                                          std::pair{"-cl-kernel-arg-info", CL_SUCCESS}}) {
    ASSERT_EQ(build(kAdd, options), CL_SUCCESS);
    kernel_ = clCreateKernel(program_, "add", &error_);
    char name[16] = "";
    EXPECT_EQ(clGetKernelArgInfo(kernel_, 0, CL_KERNEL_ARG_NAME, sizeof name, name, nullptr),
              expected);
    clReleaseKernel(kernel_);
    clReleaseProgram(program_);
    kernel_ = nullptr;
    program_ = nullptr;
  }
}

TEST_F(EmulatedGpu, ReferenceCountsAreTheProgramsOwn) {
  cl_uint count = 0;
  ASSERT_EQ(clGetCommandQueueInfo(queue_, CL_QUEUE_REFERENCE_COUNT, sizeof count, &count, nullptr),
            CL_SUCCESS);
  EXPECT_EQ(count, 1u);
  clRetainCommandQueue(queue_);
  clGetCommandQueueInfo(queue_, CL_QUEUE_REFERENCE_COUNT, sizeof count, &count, nullptr);
  EXPECT_EQ(count, 2u);
  clReleaseCommandQueue(queue_);
  cl_context context = nullptr;
  cl_device_id device = nullptr;
  clGetCommandQueueInfo(queue_, CL_QUEUE_CONTEXT, sizeof context, &context, nullptr);
  clGetCommandQueueInfo(queue_, CL_QUEUE_DEVICE, sizeof device, &device, nullptr);
  EXPECT_EQ(context, context_);
  EXPECT_EQ(device, device_);
}

std::atomic<int> destroyed{0};
void CL_CALLBACK on_destroy(cl_mem, void*) {
  ++destroyed;
}

TEST_F(EmulatedGpu, MemoryTellsWhenItIsDestroyed) {
  destroyed = 0;
  const cl_mem m = buffer(64);
  clSetMemObjectDestructorCallback(m, on_destroy, nullptr);
  clRetainMemObject(m);
  clReleaseMemObject(m);
  EXPECT_EQ(destroyed, 0);
  clReleaseMemObject(m);
  EXPECT_EQ(destroyed, 1);
}

TEST_F(EmulatedGpu, AClonedKernelHasItsArguments) {
  ASSERT_EQ(build(kAdd), CL_SUCCESS);
  kernel_ = clCreateKernel(program_, "add", &error_);
  const cl_mem m = buffer(256);
  const cl_int zero = 0, five = 5, nine = 9;
  clEnqueueFillBuffer(queue_, m, &zero, sizeof zero, 0, 256, 0, nullptr, nullptr);
  clSetKernelArg(kernel_, 0, sizeof m, &m);
  clSetKernelArg(kernel_, 1, sizeof five, &five);
  const cl_kernel clone = clCloneKernel(kernel_, &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  clSetKernelArg(kernel_, 1, sizeof nine, &nine);
  const std::size_t n = 64;
  EXPECT_EQ(clEnqueueNDRangeKernel(queue_, clone, 1, nullptr, &n, nullptr, 0, nullptr, nullptr),
            CL_SUCCESS);
  cl_int first = 0;
  clEnqueueReadBuffer(queue_, m, CL_TRUE, 0, sizeof first, &first, 0, nullptr, nullptr);
  EXPECT_EQ(first, 5);
  clReleaseKernel(clone);
  clReleaseMemObject(m);
}

struct Called {
  std::atomic<int> calls{0};
  std::atomic<cl_int> status{99};
};
void CL_CALLBACK on_event(cl_event, cl_int status, void* data) {
  static_cast<Called*>(data)->status = status;
  ++static_cast<Called*>(data)->calls;
}

TEST_F(EmulatedGpu, UserEventsHoldAndReleaseCommands) {
  ASSERT_EQ(build(kAdd), CL_SUCCESS);
  kernel_ = clCreateKernel(program_, "add", &error_);
  const cl_mem m = buffer(256);
  const cl_int one = 1;
  clSetKernelArg(kernel_, 0, sizeof m, &m);
  clSetKernelArg(kernel_, 1, sizeof one, &one);
  const cl_event gate = clCreateUserEvent(context_, &error_);
  cl_event done = nullptr;
  const std::size_t n = 64;
  ASSERT_EQ(clEnqueueNDRangeKernel(queue_, kernel_, 1, nullptr, &n, nullptr, 1, &gate, &done),
            CL_SUCCESS);
  Called called;
  clSetEventCallback(done, CL_COMPLETE, on_event, &called);
  cl_ulong ns = 0;
  EXPECT_EQ(clGetEventProfilingInfo(done, CL_PROFILING_COMMAND_END, sizeof ns, &ns, nullptr),
            CL_PROFILING_INFO_NOT_AVAILABLE);
  EXPECT_EQ(clSetUserEventStatus(gate, CL_COMPLETE), CL_SUCCESS);
  EXPECT_EQ(clFinish(queue_), CL_SUCCESS);
  EXPECT_EQ(clGetEventProfilingInfo(done, CL_PROFILING_COMMAND_END, sizeof ns, &ns, nullptr),
            CL_SUCCESS);
  while (called.calls == 0) {
  }
  EXPECT_EQ(called.status, CL_COMPLETE);
  clReleaseEvent(gate);
  clReleaseEvent(done);
  clReleaseMemObject(m);
}

TEST_F(EmulatedGpu, ImagesGoInAndOut) {
  const cl_image_format format{CL_RGBA, CL_UNSIGNED_INT8};
  cl_image_desc desc{};
  desc.image_type = CL_MEM_OBJECT_IMAGE2D;
  desc.image_width = 32;
  desc.image_height = 16;
  const cl_mem image = clCreateImage(context_, CL_MEM_READ_WRITE, &format, &desc, nullptr, &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  std::vector<unsigned char> pixels(32 * 16 * 4), back(pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<unsigned char>(i);
  const std::size_t origin[3] = {0, 0, 0}, region[3] = {32, 16, 1}, corner[3] = {1, 1, 1};
  ASSERT_EQ(clEnqueueWriteImage(queue_, image, CL_FALSE, origin, region, 0, 0, pixels.data(), 0,
                                nullptr, nullptr),
            CL_SUCCESS);
  const cl_uint colour[4] = {9, 9, 9, 9};
  cl_event filled = nullptr;
  ASSERT_EQ(clEnqueueFillImage(queue_, image, colour, origin, corner, 0, nullptr, &filled),
            CL_SUCCESS);
  ASSERT_EQ(clEnqueueReadImage(queue_, image, CL_TRUE, origin, region, 0, 0, back.data(), 0,
                               nullptr, nullptr),
            CL_SUCCESS);
  for (int i = 0; i < 4; ++i) pixels[static_cast<std::size_t>(i)] = 9;
  EXPECT_EQ(back, pixels);
  cl_command_type type = 0;
  cl_command_queue queue = nullptr;
  clGetEventInfo(filled, CL_EVENT_COMMAND_TYPE, sizeof type, &type, nullptr);
  clGetEventInfo(filled, CL_EVENT_COMMAND_QUEUE, sizeof queue, &queue, nullptr);
  EXPECT_EQ(type, cl_command_type{CL_COMMAND_FILL_IMAGE});
  EXPECT_EQ(queue, queue_);
  std::size_t row = 0;
  const auto* mapped = static_cast<unsigned char*>(
      clEnqueueMapImage(queue_, image, CL_TRUE, CL_MAP_READ, origin, region, &row, nullptr, 0,
                        nullptr, nullptr, &error_));
  ASSERT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(std::memcmp(mapped, pixels.data(), 32 * 4), 0);
  EXPECT_EQ(clEnqueueUnmapMemObject(queue_, image, const_cast<unsigned char*>(mapped), 0, nullptr,
                                    nullptr),
            CL_SUCCESS);
  clFinish(queue_);
  clReleaseEvent(filled);
  clReleaseMemObject(image);
}

class EmulatedFpga : public Emulated {
 protected:
  EmulatedFpga() : Emulated(CL_DEVICE_TYPE_ACCELERATOR) {}
};

TEST_F(EmulatedFpga, SourceIsRefused) {
  EXPECT_EQ(build(kAdd), CL_INVALID_OPERATION);
}

TEST_F(EmulatedFpga, AContainersKernelRuns) {
  layer::Container container;
  container.device = "zcu102";
  container.clock_mhz = 200;
  container.build_options = "-DSTEP=3";
  container.text =
      "__attribute__((reqd_work_group_size(1, 1, 1)))\n"
      "__kernel void count(__global int* a, int n) { for (int i = 0; i < n; ++i) a[i] = i * STEP; "
      "}";
  container.kernels.resize(1);
  container.kernels[0].name = "count";
  const std::string bytes = layer::serialize(container);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::size_t size = bytes.size();
  program_ = clCreateProgramWithBinary(context_, 1, &device_, &size, &data, nullptr, &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  ASSERT_EQ(clBuildProgram(program_, 1, &device_, "", nullptr, nullptr), CL_SUCCESS);
  kernel_ = clCreateKernel(program_, "count", &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  const cl_mem m = buffer(400);
  const cl_int n = 100;
  clSetKernelArg(kernel_, 0, sizeof m, &m);
  clSetKernelArg(kernel_, 1, sizeof n, &n);
  cl_platform_id platform = nullptr;
  clGetDeviceInfo(device_, CL_DEVICE_PLATFORM, sizeof platform, &platform, nullptr);
  const auto set_work =
      reinterpret_cast<SetWorkFn>(clGetExtensionFunctionAddressForPlatform(platform, kSetWork));
  ASSERT_NE(set_work, nullptr);
  Work work;
  work.add_loop(1'000'000, 1, 40);
  ASSERT_EQ(set_work(queue_, &work), CL_SUCCESS);
  cl_event event = nullptr;
  ASSERT_EQ(clEnqueueTask(queue_, kernel_, 0, nullptr, &event), CL_SUCCESS);
  std::vector<cl_int> back(100);
  clEnqueueReadBuffer(queue_, m, CL_TRUE, 0, 400, back.data(), 0, nullptr, nullptr);
  for (cl_int i = 0; i < n; ++i) EXPECT_EQ(back[static_cast<std::size_t>(i)], 3 * i);
  cl_ulong start = 0, end = 0;
  clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr);
  clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr);
  EXPECT_GE(end - start, 5'000'000u) << "a million cycles at 200 MHz";
  EXPECT_LT(end - start, 6'000'000u);
  clReleaseEvent(event);
  clReleaseMemObject(m);
}

/// With PARTITA_ALLOW_SOURCE=1 (an entry of its own in CMakeLists.txt).
class AllowSource : public EmulatedFpga {};

TEST_F(AllowSource, WhatIfRunsTakeSource) {
  ASSERT_EQ(build(kAdd), CL_SUCCESS) << log();
  EXPECT_TRUE(std::string(log().c_str()).empty()) << log();
  EXPECT_EQ(run_add(program_, 64, 4), std::vector<cl_int>(64, 4));
}

TEST_F(AllowSource, ThereAreNoDoubles) {
  for (const char* text :
       {"__kernel void k(__global double* a) { a[0] = 1; }",
        "__kernel void k(__global float* a) { a[0] = (float)(double4)(1).x; }",
        "#define REAL double\n__kernel void k(__global float* a) { REAL x = a[0];"
        " a[1] = x; }",
        "__kernel void k(__global float* a) { a[0] = convert_double(1) > 0; }"}) {
    EXPECT_EQ(build(text), CL_BUILD_PROGRAM_FAILURE) << text;
    EXPECT_NE(log().find("double"), std::string::npos);
    EXPECT_NE(log().find("is_not_supported_by_this_device"), std::string::npos) << log();
    clReleaseProgram(program_);
  }
  EXPECT_EQ(
      build("#ifdef cl_khr_fp64\n#error fp64\n#endif\n#ifdef __IMAGE_SUPPORT__\n#error image\n"
            "#endif\n__kernel void k(__global float* a) { a[0] = a[1] * 1.5; }"),
      CL_SUCCESS)
      << log();
}

}  // namespace
}  // namespace partita
