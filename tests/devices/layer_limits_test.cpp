// What a device cannot do fails, on the mock driver, which would take anything.
#include "tests/devices/layer_mock_fixture.h"

namespace partita::mock {
namespace {

TEST(Launch, KeepsToTheDevicesWorkGroups) {
  Rig rig(CL_DEVICE_TYPE_GPU);  // 1,024 work-items, 1,024 × 1,024 × 64
  ASSERT_EQ(rig.build("kernel"), CL_SUCCESS);
  ASSERT_EQ(rig.make_kernel("k"), CL_SUCCESS);
  EXPECT_EQ(rig.launch({2048}, {1024}), CL_SUCCESS);
  EXPECT_EQ(rig.launch({2048}, {2048}), CL_INVALID_WORK_ITEM_SIZE);
  EXPECT_EQ(rig.launch({64, 64}, {64, 64}), CL_INVALID_WORK_GROUP_SIZE);
  EXPECT_EQ(rig.launch({8, 1, 128}, {8, 1, 128}), CL_INVALID_WORK_ITEM_SIZE);
  EXPECT_EQ(rig.launch({100}, {64}), CL_INVALID_WORK_GROUP_SIZE);  // no non-uniform groups
  EXPECT_EQ(rig.launch({100}, {0}), CL_INVALID_WORK_GROUP_SIZE);
  EXPECT_EQ(rig.launch({1'000'003}, {}), CL_SUCCESS);
  std::size_t limit = 0;
  EXPECT_EQ(cl.clGetKernelWorkGroupInfo(rig.kernel, nullptr, CL_KERNEL_WORK_GROUP_SIZE,
                                        sizeof limit, &limit, nullptr),
            CL_SUCCESS);
  EXPECT_EQ(limit, 1024u);
}

TEST(Launch, ARequiredSizeIsRequired) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  ASSERT_EQ(rig.build("kernel"), CL_SUCCESS);
  ASSERT_EQ(rig.make_kernel("task"), CL_SUCCESS);
  EXPECT_EQ(rig.launch({1}, {1}), CL_SUCCESS);
  EXPECT_EQ(rig.launch({2}, {2}), CL_INVALID_WORK_GROUP_SIZE);
  EXPECT_EQ(rig.launch({1}, {}), CL_INVALID_WORK_GROUP_SIZE);
  EXPECT_EQ(cl.clEnqueueTask(rig.queue, rig.kernel, 0, nullptr, nullptr), CL_SUCCESS);
}

TEST(Launch, LocalMemoryIsWhatTheKernelHasAndWhatItsArgumentsAdd) {
  Rig rig(CL_DEVICE_TYPE_GPU);  // 49,152 bytes
  ASSERT_EQ(rig.build("kernel"), CL_SUCCESS);
  ASSERT_EQ(rig.make_kernel("wide_local"), CL_SUCCESS);  // 40,000 bytes
  EXPECT_EQ(rig.launch({64}, {64}), CL_SUCCESS);
  cl.clSetKernelArg(rig.kernel, 1, 9152, nullptr);
  EXPECT_EQ(rig.launch({64}, {64}), CL_SUCCESS);
  cl.clSetKernelArg(rig.kernel, 1, 9153, nullptr);
  EXPECT_EQ(rig.launch({64}, {64}), CL_OUT_OF_RESOURCES);
  cl_ulong bytes = 0;
  cl.clGetKernelWorkGroupInfo(rig.kernel, rig.device, CL_KERNEL_LOCAL_MEM_SIZE, sizeof bytes,
                              &bytes, nullptr);
  EXPECT_EQ(bytes, 49'153u);
}

TEST(Memory, KeepsToTheDevicesSizes) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  cl_ulong total = 0, most = 0;
  cl.clGetDeviceInfo(rig.device, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof total, &total, nullptr);
  cl.clGetDeviceInfo(rig.device, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof most, &most, nullptr);
  cl_int error = CL_SUCCESS;
  EXPECT_EQ(cl.clCreateBuffer(rig.context, 0, most + 1, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_BUFFER_SIZE);
  std::vector<cl_mem> taken;
  for (;;) {  // nothing is allocated here: the driver is a mock
    const cl_mem m = cl.clCreateBuffer(rig.context, 0, most, nullptr, &error);
    if (!m) break;
    taken.push_back(m);
  }
  EXPECT_EQ(error, CL_MEM_OBJECT_ALLOCATION_FAILURE);
  EXPECT_EQ(taken.size(), total / most);
  cl.clRetainMemObject(taken.back());
  cl.clReleaseMemObject(taken.back());
  EXPECT_EQ(cl.clCreateBuffer(rig.context, 0, most, nullptr, &error), nullptr);
  cl.clReleaseMemObject(taken.back());
  taken.back() = cl.clCreateBuffer(rig.context, 0, most, nullptr, &error);
  EXPECT_EQ(error, CL_SUCCESS);
  for (const cl_mem m : taken) cl.clReleaseMemObject(m);
}

TEST(Memory, SubBuffersAreAlignedAndKeepTheirParentsMemory) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  cl_uint bits = 0;
  cl.clGetDeviceInfo(rig.device, CL_DEVICE_MEM_BASE_ADDR_ALIGN, sizeof bits, &bits, nullptr);
  rig.make_buffer(1 << 20);
  cl_int error = CL_SUCCESS;
  cl_buffer_region region{bits / 8, 256};
  const cl_mem aligned =
      cl.clCreateSubBuffer(rig.buffer, 0, CL_BUFFER_CREATE_TYPE_REGION, &region, &error);
  EXPECT_EQ(error, CL_SUCCESS);
  region.origin = bits / 8 / 2;
  EXPECT_EQ(cl.clCreateSubBuffer(rig.buffer, 0, CL_BUFFER_CREATE_TYPE_REGION, &region, &error),
            nullptr);
  EXPECT_EQ(error, CL_MISALIGNED_SUB_BUFFER_OFFSET);
  cl.clReleaseMemObject(aligned);
}

TEST(Images, AreRefusedWhereThereAreNone) {
  Rig rig(CL_DEVICE_TYPE_ACCELERATOR);
  const cl_image_format format{CL_RGBA, CL_UNORM_INT8};
  cl_image_desc desc{};
  desc.image_type = CL_MEM_OBJECT_IMAGE2D;
  desc.image_width = desc.image_height = 16;
  cl_int error = CL_SUCCESS;
  EXPECT_EQ(cl.clCreateImage(rig.context, 0, &format, &desc, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_OPERATION);
  cl_uint count = 99;
  EXPECT_EQ(
      cl.clGetSupportedImageFormats(rig.context, 0, CL_MEM_OBJECT_IMAGE2D, 0, nullptr, &count),
      CL_SUCCESS);
  EXPECT_EQ(count, 0u);
  EXPECT_EQ(cl.clCreateSampler(rig.context, CL_FALSE, CL_ADDRESS_CLAMP, CL_FILTER_NEAREST, &error),
            nullptr);
  EXPECT_EQ(error, CL_INVALID_OPERATION);
  rig.make_buffer(64);
  EXPECT_EQ(
      cl.clEnqueueFillImage(rig.queue, rig.buffer, nullptr, nullptr, nullptr, 0, nullptr, nullptr),
      CL_INVALID_OPERATION);
}

TEST(Images, AreNotReadAndWrittenByOneKernel) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  cl_uint arguments = 99, formats = 99;
  EXPECT_EQ(cl.clGetDeviceInfo(rig.device, CL_DEVICE_MAX_READ_WRITE_IMAGE_ARGS, sizeof arguments,
                               &arguments, nullptr),
            CL_SUCCESS);
  EXPECT_EQ(arguments, 0u);
  EXPECT_EQ(cl.clGetSupportedImageFormats(rig.context, CL_MEM_KERNEL_READ_AND_WRITE,
                                          CL_MEM_OBJECT_IMAGE2D, 0, nullptr, &formats),
            CL_SUCCESS);
  EXPECT_EQ(formats, 0u);
}

TEST(WaitLists, WithoutEventsAreRefused) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  const cl_event none = nullptr;
  EXPECT_EQ(cl.clEnqueueMarkerWithWaitList(rig.queue, 1, nullptr, nullptr),
            CL_INVALID_EVENT_WAIT_LIST);
  EXPECT_EQ(cl.clEnqueueMarkerWithWaitList(rig.queue, 1, &none, nullptr),
            CL_INVALID_EVENT_WAIT_LIST);
  EXPECT_EQ(cl.clEnqueueMarkerWithWaitList(rig.queue, 0, &none, nullptr),
            CL_INVALID_EVENT_WAIT_LIST);
  EXPECT_EQ(cl.clEnqueueMarkerWithWaitList(rig.queue, 0, nullptr, nullptr), CL_SUCCESS);
}

TEST(Build, TheLanguageIsTheDevices) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  EXPECT_EQ(rig.build("kernel", "-cl-std=CL2.0"), CL_BUILD_PROGRAM_FAILURE);
  cl_build_status status = CL_BUILD_NONE;
  cl.clGetProgramBuildInfo(rig.program, rig.device, CL_PROGRAM_BUILD_STATUS, sizeof status, &status,
                           nullptr);
  EXPECT_EQ(status, CL_BUILD_ERROR);
  char log[512] = "", options[64] = "";
  cl.clGetProgramBuildInfo(rig.program, rig.device, CL_PROGRAM_BUILD_LOG, sizeof log, log, nullptr);
  EXPECT_NE(std::string(log).find("OpenCL C 2.0"), std::string::npos);
  cl.clGetProgramBuildInfo(rig.program, rig.device, CL_PROGRAM_BUILD_OPTIONS, sizeof options,
                           options, nullptr);
  EXPECT_STREQ(options, "-cl-std=CL2.0");
  EXPECT_EQ(rig.make_kernel("k"), CL_INVALID_PROGRAM_EXECUTABLE);
  EXPECT_EQ(cl.clBuildProgram(rig.program, 0, nullptr, "", nullptr, nullptr), CL_SUCCESS);
  EXPECT_EQ(rig.make_kernel("k"), CL_SUCCESS);
}

TEST(Build, TheSourceComesBackWithoutWhatTheLayerAdded) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  const char* parts[] = {"__kernel ", "void k() {} and more"};
  const std::size_t lengths[] = {0, 11};
  rig.program = cl.clCreateProgramWithSource(rig.context, 2, parts, lengths, nullptr);
  char source[128] = "";
  EXPECT_EQ(cl.clGetProgramInfo(rig.program, CL_PROGRAM_SOURCE, sizeof source, source, nullptr),
            CL_SUCCESS);
  EXPECT_STREQ(source, "__kernel void k() {}");
}

TEST(Binaries, GoBackIntoTheirOwnDeviceOnly) {
  Rig rig(CL_DEVICE_TYPE_GPU), other(CL_DEVICE_TYPE_CPU);
  ASSERT_EQ(rig.build("kernel"), CL_SUCCESS);
  std::size_t size = 0;
  ASSERT_EQ(cl.clGetProgramInfo(rig.program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr),
            CL_SUCCESS);
  std::vector<unsigned char> bytes(size);
  unsigned char* pointer = bytes.data();
  ASSERT_EQ(
      cl.clGetProgramInfo(rig.program, CL_PROGRAM_BINARIES, sizeof pointer, &pointer, nullptr),
      CL_SUCCESS);
  const unsigned char* binary = bytes.data();
  cl_int status = 0, error = 0;
  const cl_program again =
      cl.clCreateProgramWithBinary(rig.context, 1, &rig.device, &size, &binary, &status, &error);
  EXPECT_EQ(error, CL_SUCCESS);
  cl.clReleaseProgram(again);
  EXPECT_EQ(cl.clCreateProgramWithBinary(other.context, 1, &other.device, &size, &binary, &status,
                                         &error),
            nullptr);
  EXPECT_EQ(error, CL_INVALID_BINARY);
  EXPECT_EQ(status, CL_INVALID_BINARY);
  const std::size_t nothing = 0;
  EXPECT_EQ(
      cl.clCreateProgramWithBinary(rig.context, 1, &rig.device, &nothing, &binary, &status, &error),
      nullptr);
  EXPECT_EQ(error, CL_INVALID_VALUE);
  EXPECT_EQ(status, CL_INVALID_VALUE);
}

}  // namespace
}  // namespace partita::mock
