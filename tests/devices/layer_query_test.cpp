// What a program can ask about platforms, devices and contexts, on the mock driver.
#include "tests/devices/layer_mock_fixture.h"

namespace partita::mock {
namespace {

TEST(Platforms, AreTheVendorsAndTheDriverIsHidden) {
  std::vector<std::string> names;
  for (const cl_platform_id p : platforms()) {
    char name[64] = "";
    cl.clGetPlatformInfo(p, CL_PLATFORM_NAME, sizeof name, name, nullptr);
    names.push_back(name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"Xilinx", "NVIDIA CUDA", "Intel(R) OpenCL"}));
  EXPECT_EQ(cl.clGetPlatformIDs(0, nullptr, nullptr), CL_INVALID_VALUE);
  cl_platform_id one = nullptr;
  EXPECT_EQ(cl.clGetPlatformIDs(0, &one, nullptr), CL_INVALID_VALUE);
  EXPECT_EQ(cl.clGetPlatformIDs(1, &one, nullptr), CL_SUCCESS);
  EXPECT_EQ(one, platforms()[0]);
  const auto wrong = reinterpret_cast<cl_platform_id>(&one);
  EXPECT_EQ(cl.clGetPlatformInfo(wrong, CL_PLATFORM_NAME, 0, nullptr, nullptr),
            CL_INVALID_PLATFORM);
}

TEST(Devices, AreFoundByType) {
  const cl_platform_id nvidia = platforms()[1];
  cl_device_id device = nullptr;
  cl_uint count = 0;
  for (const cl_device_type type :
       {cl_device_type{CL_DEVICE_TYPE_GPU}, cl_device_type{CL_DEVICE_TYPE_ALL},
        cl_device_type{CL_DEVICE_TYPE_DEFAULT},
        cl_device_type{CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_GPU}}) {
    EXPECT_EQ(cl.clGetDeviceIDs(nvidia, type, 1, &device, &count), CL_SUCCESS);
    EXPECT_EQ(count, 1u);
  }
  EXPECT_EQ(device, device_of(CL_DEVICE_TYPE_GPU));
  for (const cl_device_type type :
       {CL_DEVICE_TYPE_CPU, CL_DEVICE_TYPE_ACCELERATOR, CL_DEVICE_TYPE_CUSTOM}) {
    EXPECT_EQ(cl.clGetDeviceIDs(nvidia, type, 1, &device, &count), CL_DEVICE_NOT_FOUND);
    EXPECT_EQ(count, 0u);
  }
  EXPECT_EQ(cl.clGetDeviceIDs(nvidia, 0, 1, &device, &count), CL_INVALID_DEVICE_TYPE);
  EXPECT_EQ(cl.clGetDeviceIDs(nvidia, 1 << 20, 1, &device, &count), CL_INVALID_DEVICE_TYPE);
  EXPECT_EQ(cl.clGetDeviceIDs(nvidia, CL_DEVICE_TYPE_ALL, 0, &device, &count), CL_INVALID_VALUE);
  EXPECT_EQ(cl.clGetDeviceIDs(nvidia, CL_DEVICE_TYPE_ALL, 0, nullptr, nullptr), CL_INVALID_VALUE);
}

TEST(Devices, AnswerEveryQueryOfTheirVersionAndOnlyThose) {
  const cl_device_id gpu = device_of(CL_DEVICE_TYPE_GPU);
  const cl_device_id fpga = device_of(CL_DEVICE_TYPE_ACCELERATOR);
  constexpr cl_device_info kHalfConfig = 0x1033, kOnlyWith30 = CL_DEVICE_NUMERIC_VERSION;
  const auto ask = [&](cl_device_info name) {
    std::size_t bytes = 0;
    EXPECT_EQ(cl.clGetDeviceInfo(gpu, name, 0, nullptr, &bytes), CL_SUCCESS) << std::hex << name;
    char small = 0;
    if (bytes > 1) {  // too small a size is refused
      EXPECT_EQ(cl.clGetDeviceInfo(gpu, name, 1, &small, nullptr), CL_INVALID_VALUE);
    }
  };
  for (cl_device_info name = CL_DEVICE_TYPE; name <= CL_DEVICE_IMAGE_MAX_ARRAY_SIZE; ++name) {
    ask(name);  // 0x1000 to 0x1041
  }
  for (cl_device_info name = CL_DEVICE_PARENT_DEVICE; name <= CL_DEVICE_PRINTF_BUFFER_SIZE;
       ++name) {
    ask(name);  // 0x1042 to 0x1049
  }
  for (cl_device_info name = CL_DEVICE_IMAGE_PITCH_ALIGNMENT;
       name <= CL_DEVICE_SUB_GROUP_INDEPENDENT_FORWARD_PROGRESS; ++name) {
    ask(name);  // 0x104A to 0x105D
  }
  for (cl_device_info name = CL_DEVICE_NUMERIC_VERSION;
       name <= CL_DEVICE_GENERIC_ADDRESS_SPACE_SUPPORT; ++name) {
    ask(name);  // 0x105E to 0x1069
  }
  EXPECT_EQ(cl.clGetDeviceInfo(gpu, kHalfConfig, 0, nullptr, nullptr), CL_SUCCESS);
  EXPECT_EQ(cl.clGetDeviceInfo(fpga, kOnlyWith30, 0, nullptr, nullptr), CL_INVALID_VALUE);
  EXPECT_EQ(cl.clGetDeviceInfo(fpga, CL_DEVICE_SVM_CAPABILITIES, 0, nullptr, nullptr),
            CL_INVALID_VALUE);
  EXPECT_EQ(cl.clGetDeviceInfo(nullptr, CL_DEVICE_NAME, 0, nullptr, nullptr), CL_INVALID_DEVICE);
}

TEST(Devices, SayWhichProfileAndNodeTheyAre) {
  EXPECT_EQ(device_text(device_of(CL_DEVICE_TYPE_ACCELERATOR), kDeviceProfile), "zcu102");
  EXPECT_EQ(device_text(device_of(CL_DEVICE_TYPE_ACCELERATOR), kDeviceNode), "zynq");
  EXPECT_EQ(device_text(device_of(CL_DEVICE_TYPE_GPU), kDeviceProfile), "gtx1060");
  EXPECT_EQ(device_text(device_of(CL_DEVICE_TYPE_GPU), kDeviceNode), "pc");
}

TEST(Devices, VersionedExtensionsAreTheExtensionString) {
  const cl_device_id gpu = device_of(CL_DEVICE_TYPE_GPU);
  std::vector<cl_name_version> list(100);
  std::size_t bytes = 0;
  ASSERT_EQ(cl.clGetDeviceInfo(gpu, CL_DEVICE_EXTENSIONS_WITH_VERSION,
                               list.size() * sizeof(cl_name_version), list.data(), &bytes),
            CL_SUCCESS);
  list.resize(bytes / sizeof(cl_name_version));
  std::string joined;
  for (const cl_name_version& e : list) {
    if (!joined.empty()) joined += ' ';
    joined += e.name;
  }
  EXPECT_EQ(joined, device_text(gpu, CL_DEVICE_EXTENSIONS));
  EXPECT_EQ(joined.find("cl_mock_only"), std::string::npos);
}

TEST(Devices, HaveNoSubDevicesAndAreNotCounted) {
  const cl_device_id gpu = device_of(CL_DEVICE_TYPE_GPU);
  const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY, 1, 0};
  cl_uint count = 0;
  EXPECT_EQ(cl.clCreateSubDevices(gpu, equally, 0, nullptr, &count), CL_INVALID_VALUE);
  EXPECT_EQ(cl.clRetainDevice(gpu), CL_SUCCESS);
  EXPECT_EQ(cl.clReleaseDevice(gpu), CL_SUCCESS);
  EXPECT_EQ(cl.clReleaseDevice(gpu), CL_SUCCESS);
  EXPECT_EQ(cl.clReleaseDevice(nullptr), CL_INVALID_DEVICE);
}

TEST(Contexts, GiveBackWhatTheyWereGiven) {
  const cl_platform_id nvidia = platforms()[1];
  const cl_device_id gpu = device_of(CL_DEVICE_TYPE_GPU);
  const cl_context_properties given[] = {CL_CONTEXT_PLATFORM,
                                         reinterpret_cast<cl_context_properties>(nvidia), 0};
  cl_int error = CL_SUCCESS;
  const cl_context context = cl.clCreateContext(given, 1, &gpu, nullptr, nullptr, &error);
  ASSERT_EQ(error, CL_SUCCESS);
  cl_context_properties back[8] = {};
  std::size_t bytes = 0;
  EXPECT_EQ(cl.clGetContextInfo(context, CL_CONTEXT_PROPERTIES, sizeof back, back, &bytes),
            CL_SUCCESS);
  EXPECT_EQ(bytes, sizeof given);
  EXPECT_EQ(back[1], given[1]);
  cl_device_id device = nullptr;
  EXPECT_EQ(cl.clGetContextInfo(context, CL_CONTEXT_DEVICES, sizeof device, &device, &bytes),
            CL_SUCCESS);
  EXPECT_EQ(device, gpu);
  EXPECT_EQ(bytes, sizeof device);
  cl.clReleaseContext(context);

  const cl_context bare = cl.clCreateContext(nullptr, 1, &gpu, nullptr, nullptr, nullptr);
  EXPECT_EQ(cl.clGetContextInfo(bare, CL_CONTEXT_PROPERTIES, 0, nullptr, &bytes), CL_SUCCESS);
  EXPECT_EQ(bytes, 0u);
  cl.clReleaseContext(bare);
}

TEST(Contexts, AreOfOnePlatform) {
  const cl_device_id both[] = {device_of(CL_DEVICE_TYPE_GPU), device_of(CL_DEVICE_TYPE_CPU)};
  cl_int error = CL_SUCCESS;
  EXPECT_EQ(cl.clCreateContext(nullptr, 2, both, nullptr, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_DEVICE);
  cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                        reinterpret_cast<cl_context_properties>(platforms()[0]), 0};
  EXPECT_EQ(cl.clCreateContext(properties, 1, both, nullptr, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_DEVICE);
  EXPECT_EQ(cl.clCreateContextFromType(properties, CL_DEVICE_TYPE_GPU, nullptr, nullptr, &error),
            nullptr);
  EXPECT_EQ(error, CL_DEVICE_NOT_FOUND);
  properties[1] = reinterpret_cast<cl_context_properties>(&error);
  EXPECT_EQ(cl.clCreateContext(properties, 1, both, nullptr, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_PLATFORM);
  EXPECT_EQ(cl.clCreateContext(nullptr, 0, nullptr, nullptr, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_VALUE);
}

TEST(Queues, ShowWhatTheProgramAskedFor) {
  Rig rig(CL_DEVICE_TYPE_GPU, 0);
  cl_command_queue_properties properties = 99;
  EXPECT_EQ(cl.clGetCommandQueueInfo(rig.queue, CL_QUEUE_PROPERTIES, sizeof properties, &properties,
                                     nullptr),
            CL_SUCCESS);
  EXPECT_EQ(properties, 0u);
  const cl_queue_properties list[] = {CL_QUEUE_PROPERTIES, CL_QUEUE_PROFILING_ENABLE, 0};
  cl_int error = CL_SUCCESS;
  const cl_command_queue queue =
      cl.clCreateCommandQueueWithProperties(rig.context, rig.device, list, &error);
  ASSERT_EQ(error, CL_SUCCESS);
  cl_queue_properties back[8] = {};
  std::size_t bytes = 0;
  EXPECT_EQ(cl.clGetCommandQueueInfo(queue, CL_QUEUE_PROPERTIES_ARRAY, sizeof back, back, &bytes),
            CL_SUCCESS);
  EXPECT_EQ(bytes, sizeof list);
  EXPECT_EQ(back[1], list[1]);
  cl.clReleaseCommandQueue(queue);
  EXPECT_EQ(cl.clCreateCommandQueue(rig.context, rig.device, 1 << 10, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_VALUE);
  EXPECT_EQ(cl.clCreateCommandQueue(rig.context, device_of(CL_DEVICE_TYPE_CPU), 0, &error),
            nullptr);
  EXPECT_EQ(error, CL_INVALID_DEVICE);
}

TEST(Absent, SharedVirtualMemoryAndPipes) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  cl_device_svm_capabilities svm = 99;
  cl.clGetDeviceInfo(rig.device, CL_DEVICE_SVM_CAPABILITIES, sizeof svm, &svm, nullptr);
  EXPECT_EQ(svm, 0u);
  EXPECT_EQ(cl.clSVMAlloc(rig.context, CL_MEM_READ_WRITE, 64, 0), nullptr);
  cl_int error = CL_SUCCESS;
  EXPECT_EQ(cl.clCreatePipe(rig.context, 0, 4, 4, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_INVALID_OPERATION);
}

TEST(Absent, SpecializationConstants) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  ASSERT_EQ(rig.build("kernel"), CL_SUCCESS);
  const cl_uint value = 42;
  EXPECT_EQ(cl.clSetProgramSpecializationConstant(rig.program, 0, sizeof value, &value),
            CL_INVALID_OPERATION);
  EXPECT_EQ(cl.clSetProgramSpecializationConstant(nullptr, 0, sizeof value, &value),
            CL_INVALID_PROGRAM);
}

}  // namespace
}  // namespace partita::mock
