// A context of two devices: what one has written has to be moved before the other can use it.
#include <array>

#include "tests/devices/layer_mock_fixture.h"

namespace partita::mock {
namespace {

constexpr std::size_t kBytes = 12'000'000;  ///< a millisecond over the GTX 1060's link
constexpr cl_ulong kMove = 1'000'000;

class TwoDevices : public testing::Test {
 protected:
  void SetUp() override {
    cl_uint count = 0;
    cl.clGetDeviceIDs(platforms()[0], CL_DEVICE_TYPE_GPU, 2, devices.data(), &count);
    ASSERT_EQ(count, 2u);
    context = cl.clCreateContext(nullptr, 2, devices.data(), nullptr, nullptr, nullptr);
    for (std::size_t i = 0; i < 2; ++i) {
      queues[i] = cl.clCreateCommandQueue(context, devices[i], CL_QUEUE_PROFILING_ENABLE, nullptr);
    }
    const char* text = "__kernel void k(__global int* a) { a[0] = 1; }";
    program = cl.clCreateProgramWithSource(context, 1, &text, nullptr, nullptr);
    ASSERT_EQ(cl.clBuildProgram(program, 0, nullptr, "", nullptr, nullptr), CL_SUCCESS);
    kernel = cl.clCreateKernel(program, "k", nullptr);
    buffer = cl.clCreateBuffer(context, CL_MEM_READ_WRITE, kBytes, nullptr, nullptr);
    cl.clSetKernelArg(kernel, 0, sizeof buffer, &buffer);
  }
  void TearDown() override {
    cl.clReleaseMemObject(buffer);
    cl.clReleaseKernel(kernel);
    cl.clReleaseProgram(program);
    for (const cl_command_queue q : queues) cl.clReleaseCommandQueue(q);
    cl.clReleaseContext(context);
  }

  /// How long after the host's call the launch starts.
  cl_ulong delay_of_launch(std::size_t device, std::vector<cl_event> waits = {}) {
    const std::size_t items = 64;
    cl_event event = nullptr;
    EXPECT_EQ(cl.clEnqueueNDRangeKernel(queues[device], kernel, 1, nullptr, &items, nullptr,
                                        static_cast<cl_uint>(waits.size()),
                                        waits.empty() ? nullptr : waits.data(), &event),
              CL_SUCCESS);
    cl.clWaitForEvents(1, &event);
    const cl_ulong delay =
        time_of(event, CL_PROFILING_COMMAND_START) - time_of(event, CL_PROFILING_COMMAND_QUEUED);
    cl.clReleaseEvent(event);
    return delay;
  }

  std::array<cl_device_id, 2> devices{};
  std::array<cl_command_queue, 2> queues{};
  cl_context context = nullptr;
  cl_program program = nullptr;
  cl_kernel kernel = nullptr;
  cl_mem buffer = nullptr;
};

TEST_F(TwoDevices, WhatOneWroteIsMovedToTheOther) {
  EXPECT_LT(delay_of_launch(0), kMove) << "nothing was written yet";
  EXPECT_GT(delay_of_launch(1), kMove);
  EXPECT_LT(delay_of_launch(1), kMove) << "it is there already";
  EXPECT_GT(delay_of_launch(0), kMove);
}

TEST_F(TwoDevices, OverwritingMovesNothing) {
  delay_of_launch(0);
  std::vector<char> bytes(16);
  EXPECT_EQ(cl.clEnqueueWriteBuffer(queues[1], buffer, CL_TRUE, 0, bytes.size(), bytes.data(), 0,
                                    nullptr, nullptr),
            CL_SUCCESS);
  EXPECT_LT(delay_of_launch(1), kMove);
}

TEST_F(TwoDevices, ASubBufferIsWhereItsParentIs) {
  const cl_buffer_region region{0, kBytes / 2};
  const cl_mem half =
      cl.clCreateSubBuffer(buffer, 0, CL_BUFFER_CREATE_TYPE_REGION, &region, nullptr);
  delay_of_launch(0);
  cl.clSetKernelArg(kernel, 0, sizeof half, &half);
  const cl_ulong delay = delay_of_launch(1);
  EXPECT_GT(delay, kMove / 2);
  cl.clReleaseMemObject(half);
}

TEST_F(TwoDevices, AMoveWaitsForWhatTheCommandWaitsFor) {
  delay_of_launch(0);
  const cl_event gate = cl.clCreateUserEvent(context, nullptr);
  const std::size_t items = 64;
  cl_event event = nullptr;
  ASSERT_EQ(
      cl.clEnqueueNDRangeKernel(queues[1], kernel, 1, nullptr, &items, nullptr, 1, &gate, &event),
      CL_SUCCESS);
  const auto wait_until = extension<WaitUntilFn>(kWaitUntil);
  const auto host_clock = extension<HostClockFn>(kHostClock);
  cl_ulong now = 0;
  host_clock(&now);
  wait_until(now + 50 * kMove);
  cl.clSetUserEventStatus(gate, CL_COMPLETE);
  EXPECT_GT(time_of(event, CL_PROFILING_COMMAND_START), now + 51 * kMove);
  cl.clReleaseEvent(event);
  cl.clReleaseEvent(gate);
}

}  // namespace
}  // namespace partita::mock
