// PARTITA_FAULT: what it says, and what a device then does. The test's environment names the
// faults (see CMakeLists.txt): gtx1060 stalls at its 3rd command for 5 ms and is lost at its 6th;
// the 2nd allocation of i5-8500 fails; zcu102 takes no program.
#include "devices/layer/fault.h"
#include "tests/devices/layer_mock_fixture.h"

namespace partita::layer {
namespace {

TEST(FaultSpec, IsReadStrictly) {
  const auto faults = parse_faults("device=a:lost@3,device=b:build-fail,device=c:stall@2=10");
  ASSERT_EQ(faults.size(), 3u);
  EXPECT_EQ(faults[0], (Fault{"a", FaultKind::lost, 3, 0}));
  EXPECT_EQ(faults[1], (Fault{"b", FaultKind::build_fail, 0, 0}));
  EXPECT_EQ(faults[2], (Fault{"c", FaultKind::stall, 2, 10'000'000}));
  EXPECT_TRUE(parse_faults("").empty());
  for (const char* bad :
       {"device=a", "a:lost@1", "device=:lost@1", "device=a:lost", "device=a:lost@",
        "device=a:lost@0", "device=a:lost@1x", "device=a:lost@-1", "device=a:burn",
        "device=a:stall@1", "device=a:stall@1=", "device=a:build-fail,",
        "device=a:lost@99999999999999999999"}) {
    EXPECT_THROW(parse_faults(bad), std::invalid_argument) << bad;
  }
}

}  // namespace
}  // namespace partita::layer

namespace partita::mock {
namespace {

TEST(Fault, AStalledCommandStartsLateAndALostDeviceIsGone) {
  Rig rig(CL_DEVICE_TYPE_GPU);
  ASSERT_EQ(rig.build("kernel"), CL_SUCCESS);
  ASSERT_EQ(rig.make_kernel("k"), CL_SUCCESS);
  cl_event events[5];
  for (cl_event& e : events) ASSERT_EQ(rig.launch({64}, {64}, &e), CL_SUCCESS);
  const cl_ulong usual = time_of(events[1], CL_PROFILING_COMMAND_START);
  const cl_ulong stalled = time_of(events[2], CL_PROFILING_COMMAND_START);
  EXPECT_LT(usual, 1'000'000u);
  EXPECT_GE(stalled, 5'000'000u);
  EXPECT_EQ(rig.launch({64}, {64}), CL_OUT_OF_RESOURCES);
  EXPECT_EQ(rig.launch({64}, {64}), CL_OUT_OF_RESOURCES);
  EXPECT_EQ(cl.clFinish(rig.queue), CL_OUT_OF_RESOURCES);
  cl_bool available = CL_TRUE;
  cl.clGetDeviceInfo(rig.device, CL_DEVICE_AVAILABLE, sizeof available, &available, nullptr);
  EXPECT_EQ(available, CL_FALSE);
  for (const cl_event e : events) cl.clReleaseEvent(e);
}

TEST(Fault, MemoryRunsOut) {
  Rig rig(CL_DEVICE_TYPE_CPU);
  cl_int error = CL_SUCCESS;
  rig.make_buffer(64);
  ASSERT_NE(rig.buffer, nullptr);
  EXPECT_EQ(cl.clCreateBuffer(rig.context, CL_MEM_READ_WRITE, 64, nullptr, &error), nullptr);
  EXPECT_EQ(error, CL_MEM_OBJECT_ALLOCATION_FAILURE);
  const cl_mem third = cl.clCreateBuffer(rig.context, CL_MEM_READ_WRITE, 64, nullptr, &error);
  EXPECT_EQ(error, CL_SUCCESS);
  cl.clReleaseMemObject(third);
}

TEST(Fault, ABuildFails) {
  Rig rig(CL_DEVICE_TYPE_ACCELERATOR);
  const std::string bytes = layer::serialize(small_container());
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::size_t size = bytes.size();
  cl_int error = CL_SUCCESS;
  EXPECT_EQ(
      cl.clCreateProgramWithBinary(rig.context, 1, &rig.device, &size, &data, nullptr, &error),
      nullptr);
  EXPECT_EQ(error, CL_INVALID_BINARY);
}

}  // namespace
}  // namespace partita::mock
