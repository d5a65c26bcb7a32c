// The rules of an FPGA, on the mock driver.
#include "tests/devices/layer_mock_fixture.h"

namespace partita::mock {
namespace {

std::vector<std::string>& told() {
  static std::vector<std::string> lines;
  return lines;
}

void CL_CALLBACK on_notify(const char* line, const void*, std::size_t, void*) {
  told().push_back(line);
}

class Fpga : public testing::Test {
 protected:
  Fpga() : device_(device_of(CL_DEVICE_TYPE_ACCELERATOR)) {
    told().clear();
    context_ = cl.clCreateContext(nullptr, 1, &device_, on_notify, nullptr, nullptr);
    queue_ = cl.clCreateCommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE, nullptr);
  }
  ~Fpga() override {
    cl.clReleaseCommandQueue(queue_);
    cl.clReleaseContext(context_);
  }
  cl_program load(const layer::Container& container) { return load(layer::serialize(container)); }
  cl_program load(const std::string& bytes) {
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    const std::size_t size = bytes.size();
    return cl.clCreateProgramWithBinary(context_, 1, &device_, &size, &data, &status_, &error_);
  }

  cl_device_id device_ = nullptr;
  cl_context context_ = nullptr;
  cl_command_queue queue_ = nullptr;
  cl_int status_ = 0, error_ = 0;
};

TEST_F(Fpga, RefusesSource) {
  const char* text = "__kernel void k() {}";
  EXPECT_EQ(cl.clCreateProgramWithSource(context_, 1, &text, nullptr, &error_), nullptr);
  EXPECT_EQ(error_, CL_INVALID_OPERATION);
  cl_bool compiler = CL_TRUE;
  cl.clGetDeviceInfo(device_, CL_DEVICE_COMPILER_AVAILABLE, sizeof compiler, &compiler, nullptr);
  EXPECT_EQ(compiler, CL_FALSE);
}

TEST_F(Fpga, RunsAContainersKernelsAndOnlyThose) {
  const cl_program program = load(small_container());
  ASSERT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(cl.clBuildProgram(program, 0, nullptr, "", nullptr, nullptr), CL_SUCCESS);
  const cl_kernel kernel = cl.clCreateKernel(program, "task", &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(cl.clCreateKernel(program, "other", &error_), nullptr);
  EXPECT_EQ(error_, CL_INVALID_KERNEL_NAME);
  const std::size_t one = 1, two = 2;
  EXPECT_EQ(cl.clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &one, &one, 0, nullptr, nullptr),
            CL_SUCCESS);
  EXPECT_EQ(cl.clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &two, &two, 0, nullptr, nullptr),
            CL_INVALID_WORK_GROUP_SIZE);
  std::size_t size = 0;
  cl.clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr);
  EXPECT_EQ(size, layer::serialize(small_container()).size());
  cl.clReleaseKernel(kernel);
  cl.clReleaseProgram(program);
}

TEST_F(Fpga, HoldsOneContainerUntilAllOfItIsReleased) {
  layer::Container other = small_container();
  other.clock_mhz = 150;
  const cl_program first = load(small_container());
  ASSERT_EQ(error_, CL_SUCCESS);
  cl.clBuildProgram(first, 0, nullptr, "", nullptr, nullptr);
  const cl_program same = load(small_container());
  EXPECT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(load(other), nullptr);
  EXPECT_EQ(error_, CL_OUT_OF_RESOURCES);
  ASSERT_FALSE(told().empty());
  const cl_kernel kernel = cl.clCreateKernel(first, "task", &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  cl.clReleaseProgram(first);
  cl.clReleaseProgram(same);
  EXPECT_EQ(load(other), nullptr) << "a kernel is alive";
  EXPECT_EQ(error_, CL_OUT_OF_RESOURCES);
  cl.clReleaseKernel(kernel);
  const cl_program second = load(other);
  EXPECT_EQ(error_, CL_SUCCESS);
  cl.clReleaseProgram(second);
}

TEST_F(Fpga, LoadingTakesTimeOnce) {
  const auto clock = extension<HostClockFn>(kHostClock);
  layer::Container fresh = small_container();
  fresh.clock_mhz = 123;
  cl_ulong before = 0, loaded = 0, again = 0;
  clock(&before);
  const cl_program program = load(fresh);
  clock(&loaded);
  const cl_program twice = load(fresh);
  clock(&again);
  EXPECT_GT(loaded - before, 10'000'000u);  // a whole bitstream: tens of milliseconds
  EXPECT_EQ(again, loaded);
  cl.clReleaseProgram(program);
  cl.clReleaseProgram(twice);
}

TEST_F(Fpga, RefusesWhatIsNotForItOrDoesNotFit) {
  layer::Container c = small_container();
  c.device = "zcu104";
  EXPECT_EQ(load(c), nullptr);
  EXPECT_EQ(error_, CL_INVALID_BINARY);
  EXPECT_EQ(status_, CL_INVALID_BINARY);
  ASSERT_EQ(told().size(), 1u);
  EXPECT_NE(told()[0].find("zcu104"), std::string::npos);
  c = small_container();
  c.area = {283900, 193700, 1294, 0, 565};  // the paper's front-end and back-end together
  EXPECT_EQ(load(c), nullptr);
  EXPECT_EQ(error_, CL_INVALID_BINARY);
  ASSERT_EQ(told().size(), 2u);
  EXPECT_EQ(told()[1].find('\n'), std::string::npos);
  EXPECT_EQ(load(layer::serialize(small_container()).substr(0, 100)), nullptr);
  EXPECT_EQ(error_, CL_INVALID_BINARY);
  EXPECT_EQ(load(std::string("xclbin2")), nullptr);
  EXPECT_EQ(error_, CL_INVALID_BINARY);
  c = small_container();
  c.text = "syntax error";
  EXPECT_EQ(load(c), nullptr);
  EXPECT_EQ(error_, CL_INVALID_BINARY);
}

TEST_F(Fpga, AGpuTakesNoContainer) {
  Rig gpu(CL_DEVICE_TYPE_GPU);
  const std::string bytes = layer::serialize(small_container());
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::size_t size = bytes.size();
  EXPECT_EQ(
      cl.clCreateProgramWithBinary(gpu.context, 1, &gpu.device, &size, &data, &status_, &error_),
      nullptr);
  EXPECT_EQ(error_, CL_INVALID_BINARY);
}

TEST_F(Fpga, ChargesNoLocalArraysButLocalArguments) {
  layer::Container c = small_container();
  c.kernels[0].name = "wide_local";  // 40,000 bytes of static local memory, against 16 KiB
  const cl_program program = load(c);
  ASSERT_EQ(error_, CL_SUCCESS);
  const cl_kernel kernel = cl.clCreateKernel(program, "wide_local", &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  const std::size_t one = 1;
  EXPECT_EQ(cl.clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &one, &one, 0, nullptr, nullptr),
            CL_SUCCESS);
  cl.clSetKernelArg(kernel, 1, 16385, nullptr);
  EXPECT_EQ(cl.clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &one, &one, 0, nullptr, nullptr),
            CL_OUT_OF_RESOURCES);
  cl.clReleaseKernel(kernel);
  cl.clReleaseProgram(program);
}

}  // namespace
}  // namespace partita::mock
