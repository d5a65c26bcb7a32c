// Predicted times as a program sees them, on the mock driver.
#include <atomic>
#include <thread>

#include "devices/layer/state.h"
#include "tests/devices/layer_mock_fixture.h"

namespace partita::mock {
namespace {

cl_int profiling_error(cl_event event) {
  cl_ulong ns = 0;
  return cl.clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof ns, &ns, nullptr);
}

cl_ulong host_clock() {
  cl_ulong ns = 0;
  extension<HostClockFn>(kHostClock)(&ns);
  return ns;
}

Work some_work() {
  Work work;
  work[OpClass::float_fma] = 100'000'000;
  work.read_issued = work.read_unique = 8'000'000;
  work.written_issued = work.written_unique = 8'000'000;
  return work;
}

class Clock : public testing::Test {
 protected:
  Clock() : rig_(CL_DEVICE_TYPE_GPU) {
    rig_.build("kernel");
    rig_.make_kernel("k");
    rig_.make_buffer(1 << 20);
  }
  cl_int launch(cl_event* event, std::vector<cl_event> waits = {}) {
    const Work work = some_work();
    extension<SetWorkFn>(kSetWork)(rig_.queue, &work);
    return rig_.launch({65536}, {256}, event, waits);
  }
  cl_event user_event() { return cl.clCreateUserEvent(rig_.context, nullptr); }

  Rig rig_;
};

TEST_F(Clock, CommandsOfAQueueFollowOneAnother) {
  std::vector<char> host(1 << 20);
  cl_event events[3];
  ASSERT_EQ(cl.clEnqueueWriteBuffer(rig_.queue, rig_.buffer, CL_FALSE, 0, host.size(), host.data(),
                                    0, nullptr, &events[0]),
            CL_SUCCESS);
  ASSERT_EQ(launch(&events[1]), CL_SUCCESS);
  ASSERT_EQ(cl.clEnqueueReadBuffer(rig_.queue, rig_.buffer, CL_TRUE, 0, host.size(), host.data(), 0,
                                   nullptr, &events[2]),
            CL_SUCCESS);
  const cl_ulong after = host_clock();
  cl_ulong previous_end = 0;
  for (const cl_event e : events) {
    const cl_ulong queued = time_of(e, CL_PROFILING_COMMAND_QUEUED);
    const cl_ulong submit = time_of(e, CL_PROFILING_COMMAND_SUBMIT);
    const cl_ulong start = time_of(e, CL_PROFILING_COMMAND_START);
    const cl_ulong end = time_of(e, CL_PROFILING_COMMAND_END);
    EXPECT_LE(queued, submit);
    EXPECT_LE(submit, start);
    EXPECT_LT(start, end);
    EXPECT_GE(start, previous_end);
    EXPECT_EQ(time_of(e, CL_PROFILING_COMMAND_COMPLETE), end);
    previous_end = end;
    cl.clReleaseEvent(e);
  }
  EXPECT_GE(after, previous_end) << "a blocking read waits";
}

TEST_F(Clock, DeclaredWorkIsUsedOnce) {
  cl_event with = nullptr, without = nullptr;
  ASSERT_EQ(launch(&with), CL_SUCCESS);
  ASSERT_EQ(rig_.launch({65536}, {256}, &without), CL_SUCCESS);
  const auto duration = [](cl_event e) {
    return time_of(e, CL_PROFILING_COMMAND_END) - time_of(e, CL_PROFILING_COMMAND_START);
  };
  EXPECT_NE(duration(with), duration(without));
  cl.clReleaseEvent(with);
  cl.clReleaseEvent(without);
  Work old = some_work();
  old.struct_size = 8;
  EXPECT_EQ(extension<SetWorkFn>(kSetWork)(rig_.queue, &old), CL_INVALID_VALUE);
}

TEST_F(Clock, AUserEventHoldsTheTimesBack) {
  const cl_event gate = user_event();
  cl_event after = nullptr;
  ASSERT_EQ(launch(&after, {gate}), CL_SUCCESS);
  EXPECT_EQ(profiling_error(after), CL_PROFILING_INFO_NOT_AVAILABLE);
  EXPECT_EQ(profiling_error(gate), CL_PROFILING_INFO_NOT_AVAILABLE);
  extension<WaitUntilFn>(kWaitUntil)(host_clock() + 50'000'000);
  const cl_ulong opened = host_clock();
  EXPECT_EQ(cl.clSetUserEventStatus(gate, CL_COMPLETE), CL_SUCCESS);
  EXPECT_EQ(cl.clSetUserEventStatus(gate, CL_COMPLETE), CL_INVALID_OPERATION);
  EXPECT_EQ(cl.clSetUserEventStatus(after, CL_COMPLETE), CL_INVALID_EVENT);
  EXPECT_GE(time_of(after, CL_PROFILING_COMMAND_START), opened);
  EXPECT_LT(time_of(after, CL_PROFILING_COMMAND_QUEUED), opened);
  EXPECT_EQ(profiling_error(gate), CL_PROFILING_INFO_NOT_AVAILABLE);
  cl.clReleaseEvent(gate);
  cl.clReleaseEvent(after);
}

TEST_F(Clock, AFailedUserEventEndsWhatWaitsForIt) {
  const cl_event gate = user_event();
  cl_event after = nullptr;
  ASSERT_EQ(launch(&after, {gate}), CL_SUCCESS);
  EXPECT_EQ(cl.clSetUserEventStatus(gate, 5), CL_INVALID_VALUE);
  EXPECT_EQ(cl.clSetUserEventStatus(gate, -7), CL_SUCCESS);
  EXPECT_EQ(cl.clWaitForEvents(1, &after), CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST);
  EXPECT_EQ(profiling_error(after), CL_PROFILING_INFO_NOT_AVAILABLE);
  cl.clReleaseEvent(gate);
  cl.clReleaseEvent(after);
}

TEST_F(Clock, ThereIsNoProfilingWithoutAskingForIt) {
  Rig quiet(CL_DEVICE_TYPE_GPU, 0);
  quiet.build("kernel");
  quiet.make_kernel("k");
  cl_event event = nullptr;
  ASSERT_EQ(quiet.launch({64}, {64}, &event), CL_SUCCESS);
  EXPECT_EQ(profiling_error(event), CL_PROFILING_INFO_NOT_AVAILABLE);
  cl_ulong ns = 0;
  EXPECT_EQ(cl.clGetEventProfilingInfo(event, 0x1234, sizeof ns, &ns, nullptr), CL_INVALID_VALUE);
  cl.clReleaseEvent(event);
}

struct Seen {
  cl_ulong clock = 0;
  int calls = 0;
};

void CL_CALLBACK on_event(cl_event, cl_int, void* data) {
  auto* seen = static_cast<Seen*>(data);
  seen->clock = host_clock();
  ++seen->calls;
}

TEST_F(Clock, ACallbackRunsAtItsEventsEnd) {
  const cl_event gate = user_event();
  cl_event event = nullptr;
  ASSERT_EQ(launch(&event, {gate}), CL_SUCCESS);
  Seen seen;
  ASSERT_EQ(cl.clSetEventCallback(event, CL_COMPLETE, on_event, &seen), CL_SUCCESS);
  EXPECT_EQ(seen.calls, 0);
  const cl_ulong before = host_clock();
  cl.clSetUserEventStatus(gate, CL_COMPLETE);
  EXPECT_EQ(seen.calls, 1);
  EXPECT_EQ(seen.clock, time_of(event, CL_PROFILING_COMMAND_END));
  EXPECT_GT(seen.clock, before);
  cl.clReleaseEvent(gate);
  cl.clReleaseEvent(event);
}

TEST_F(Clock, ReadingMappedBytesCostsTimeAndWritingThemBackToo) {
  const auto duration = [&](cl_map_flags flags, bool unmap) {
    cl_event mapped = nullptr, unmapped = nullptr;
    void* p = cl.clEnqueueMapBuffer(rig_.queue, rig_.buffer, CL_TRUE, flags, 0, 1 << 20, 0, nullptr,
                                    &mapped, nullptr);
    cl.clEnqueueUnmapMemObject(rig_.queue, rig_.buffer, p, 0, nullptr, &unmapped);
    const cl_event e = unmap ? unmapped : mapped;
    const cl_ulong ns =
        time_of(e, CL_PROFILING_COMMAND_END) - time_of(e, CL_PROFILING_COMMAND_START);
    cl.clReleaseEvent(mapped);
    cl.clReleaseEvent(unmapped);
    return ns;
  };
  const cl_ulong moved = duration(CL_MAP_READ, false);
  EXPECT_GT(moved, 50'000u);  // a megabyte over PCIe
  EXPECT_LT(duration(CL_MAP_READ, true), moved / 2);
  EXPECT_LT(duration(CL_MAP_WRITE_INVALIDATE_REGION, false), moved / 2);
  EXPECT_EQ(duration(CL_MAP_WRITE_INVALIDATE_REGION, true), moved);
}

TEST_F(Clock, ReferenceCountsAreTheProgramsOwn) {
  cl_event event = nullptr;
  ASSERT_EQ(launch(&event), CL_SUCCESS);
  const auto count = [&] {
    cl_uint n = 0;
    cl.clGetEventInfo(event, CL_EVENT_REFERENCE_COUNT, sizeof n, &n, nullptr);
    return n;
  };
  EXPECT_EQ(count(), 1u);
  cl.clRetainEvent(event);
  EXPECT_EQ(count(), 2u);
  cl.clReleaseEvent(event);
  EXPECT_EQ(count(), 1u);
  cl.clReleaseEvent(event);
}

TEST(Tables, AreEmptyWhenEverythingIsReleased) {
  const auto before = live_objects();
  {
    Rig rig(CL_DEVICE_TYPE_GPU);
    rig.build("kernel");
    rig.make_kernel("k");
    rig.make_buffer(4096);
    for (int i = 0; i < 100; ++i) {
      cl_event event = nullptr;
      rig.launch({64}, {64}, &event);
      rig.launch({64}, {64});
      cl.clReleaseEvent(event);
    }
  }
  EXPECT_EQ(live_objects(), before);
  layer::State& s = layer::state();
  const layer::Lock lock(s.mutex);
  EXPECT_EQ(s.events.size(), 0u);
  EXPECT_EQ(s.queues.size(), 0u);
  EXPECT_EQ(s.kernels.size(), 0u);
  EXPECT_EQ(s.programs.size(), 0u);
  EXPECT_EQ(s.memories.size(), 0u);
  EXPECT_EQ(s.contexts.size(), 0u);
}

/// Threads that share a context and an event gate, each with a queue of its own.
TEST(Threads, EnqueueSideBySide) {
  const auto before = live_objects();
  {
    Rig rig(CL_DEVICE_TYPE_GPU);
    rig.build("kernel");
    std::atomic<int> failures{0};
    const auto act = [&](int number) {
      cl_int error = CL_SUCCESS;
      const cl_command_queue queue = cl.clCreateCommandQueue(
          rig.context, rig.device,
          CL_QUEUE_PROFILING_ENABLE | (number % 2 ? CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE : 0),
          &error);
      const cl_kernel kernel = cl.clCreateKernel(rig.program, "k", &error);
      cl_event previous = nullptr;
      for (int i = 0; i < 300; ++i) {
        const cl_event gate = cl.clCreateUserEvent(rig.context, &error);
        cl_event waits[] = {gate, previous};
        cl_event event = nullptr;
        const std::size_t global = 256, local = 64;
        error = cl.clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &global, &local,
                                          previous ? 2 : 1, waits, &event);
        if (error != CL_SUCCESS) ++failures;
        Seen seen;
        cl.clSetEventCallback(event, CL_COMPLETE, on_event, &seen);
        cl.clSetUserEventStatus(gate, CL_COMPLETE);
        cl.clWaitForEvents(1, &event);
        if (seen.calls != 1) ++failures;
        cl_ulong ns = 0;
        if (cl.clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof ns, &ns, nullptr) !=
                CL_SUCCESS ||
            ns != seen.clock) {
          ++failures;
        }
        cl.clReleaseEvent(gate);
        if (previous) cl.clReleaseEvent(previous);
        previous = event;
      }
      cl.clReleaseEvent(previous);
      cl.clFinish(queue);
      cl.clReleaseKernel(kernel);
      cl.clReleaseCommandQueue(queue);
    };
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(act, i);
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(failures, 0);
  }
  EXPECT_EQ(live_objects(), before);
}

TEST(Extension, HostStepsAndLabelsMoveTheClock) {
  extension<BindThreadFn>(kBindThread)("scene", 1, device_of(CL_DEVICE_TYPE_GPU));
  EXPECT_EQ(extension<SetLabelFn>(kSetLabel)("depth", 3), CL_SUCCESS);
  const cl_ulong before = host_clock();
  Work work;
  work.kind = WorkKind::serial;
  work[OpClass::float_add] = 1'000'000;
  EXPECT_EQ(extension<HostStepFn>(kHostStep)("triangulate", &work), CL_SUCCESS);
  EXPECT_GT(host_clock(), before);
  EXPECT_EQ(extension<HostStepFn>(kHostStep)(nullptr, &work), CL_INVALID_VALUE);
  const cl_ulong stepped = host_clock();
  EXPECT_EQ(extension<SensorInputFn>(kSensorInput)("images", 1 << 20), CL_SUCCESS);
  EXPECT_GT(host_clock(), stepped) << "the cameras are on another node";
  EXPECT_EQ(extension<BindThreadFn>(kBindThread)("x", 1, reinterpret_cast<cl_device_id>(&work)),
            CL_INVALID_DEVICE);
  EXPECT_EQ(cl.clGetExtensionFunctionAddressForPlatform(platforms()[0], "clNothing"), nullptr);
}

}  // namespace
}  // namespace partita::mock
