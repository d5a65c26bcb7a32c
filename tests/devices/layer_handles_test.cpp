// What a program gets for null and for handles of another kind: OpenCL's error, before the driver.
#include <functional>

#include "tests/devices/layer_mock_fixture.h"

namespace partita::mock {
namespace {

/// One handle of every kind.
struct Handles : Rig {
  Handles() : Rig(CL_DEVICE_TYPE_GPU) {
    build("__kernel void k() {}");
    make_kernel("k");
    make_buffer(64);
    event = cl.clCreateUserEvent(context, nullptr);
  }
  ~Handles() { cl.clReleaseEvent(event); }

  /// Null, and every handle but `right`.
  std::vector<void*> wrong_for(void* right) const {
    std::vector<void*> list{nullptr};
    for (void* h : std::initializer_list<void*>{device, context, queue, program, kernel, buffer,
                                                event, platforms()[0]}) {
      if (h != right) list.push_back(h);
    }
    return list;
  }

  cl_event event = nullptr;
};

using Call = std::function<cl_int(void*)>;

void expect_refused(const Handles& handles, void* right, cl_int error, std::vector<Call> calls) {
  for (void* wrong : handles.wrong_for(right)) {
    for (std::size_t i = 0; i < calls.size(); ++i) EXPECT_EQ(calls[i](wrong), error) << i;
  }
}

template <typename Create>
cl_int error_of(Create&& create) {
  cl_int error = CL_SUCCESS;
  EXPECT_EQ(create(&error), nullptr);
  return error;
}

TEST(Handles, OfContextsAndQueues) {
  const Handles h;
  expect_refused(
      h, h.context, CL_INVALID_CONTEXT,
      {[](void* p) { return cl.clRetainContext(static_cast<cl_context>(p)); },
       [](void* p) { return cl.clReleaseContext(static_cast<cl_context>(p)); },
       [](void* p) {
         return error_of([p](cl_int* e) {
           return cl.clCreateBuffer(static_cast<cl_context>(p), 0, 64, nullptr, e);
         });
       },
       [](void* p) {
         return error_of(
             [p](cl_int* e) { return cl.clCreateUserEvent(static_cast<cl_context>(p), e); });
       },
       [&](void* p) {
         return cl.clSetDefaultDeviceCommandQueue(static_cast<cl_context>(p), h.device, h.queue);
       }});
  expect_refused(h, h.queue, CL_INVALID_COMMAND_QUEUE,
                 {[](void* p) { return cl.clRetainCommandQueue(static_cast<cl_command_queue>(p)); },
                  [](void* p) { return cl.clFinish(static_cast<cl_command_queue>(p)); },
                  [](void* p) {
                    return cl.clSetCommandQueueProperty(static_cast<cl_command_queue>(p), 0,
                                                        CL_TRUE, nullptr);
                  },
                  [](void* p) {
                    return cl.clEnqueueMarkerWithWaitList(static_cast<cl_command_queue>(p), 0,
                                                          nullptr, nullptr);
                  },
                  [&](void* p) {
                    const std::size_t one = 1;
                    return cl.clEnqueueNDRangeKernel(static_cast<cl_command_queue>(p), h.kernel, 1,
                                                     nullptr, &one, nullptr, 0, nullptr, nullptr);
                  }});
}

TEST(Handles, OfMemory) {
  const Handles h;
  char bytes[4];
  expect_refused(h, h.buffer, CL_INVALID_MEM_OBJECT,
                 {[](void* p) { return cl.clRetainMemObject(static_cast<cl_mem>(p)); },
                  [](void* p) { return cl.clReleaseMemObject(static_cast<cl_mem>(p)); },
                  [&](void* p) {
                    return cl.clEnqueueReadBuffer(h.queue, static_cast<cl_mem>(p), CL_TRUE, 0, 4,
                                                  bytes, 0, nullptr, nullptr);
                  },
                  [&](void* p) {
                    const auto memory = static_cast<cl_mem>(p);
                    return cl.clEnqueueMigrateMemObjects(h.queue, 1, &memory, 0, 0, nullptr,
                                                         nullptr);
                  }});
}

TEST(Handles, InKernelArguments) {
  const Handles h;
  const auto set = [&](void* handle) {
    return cl.clSetKernelArg(h.kernel, 0, sizeof handle, &handle);
  };
  EXPECT_EQ(set(nullptr), CL_SUCCESS) << "a null buffer is one";
  EXPECT_EQ(set(h.buffer), CL_SUCCESS);
  for (void* wrong :
       {static_cast<void*>(h.queue), static_cast<void*>(h.program), static_cast<void*>(h.device)}) {
    EXPECT_EQ(set(wrong), CL_INVALID_MEM_OBJECT);
  }
}

TEST(Handles, OfProgramsAndKernels) {
  const Handles h;
  expect_refused(
      h, h.program, CL_INVALID_PROGRAM,
      {[](void* p) { return cl.clRetainProgram(static_cast<cl_program>(p)); },
       [](void* p) {
         return cl.clBuildProgram(static_cast<cl_program>(p), 0, nullptr, "", nullptr, nullptr);
       },
       [](void* p) {
         return error_of(
             [p](cl_int* e) { return cl.clCreateKernel(static_cast<cl_program>(p), "k", e); });
       }});
  expect_refused(
      h, h.kernel, CL_INVALID_KERNEL,
      {[](void* p) { return cl.clRetainKernel(static_cast<cl_kernel>(p)); },
       [](void* p) { return cl.clSetKernelArg(static_cast<cl_kernel>(p), 0, 4, nullptr); },
       [&](void* p) {
         const std::size_t one = 1;
         return cl.clEnqueueNDRangeKernel(h.queue, static_cast<cl_kernel>(p), 1, nullptr, &one,
                                          nullptr, 0, nullptr, nullptr);
       }});
}

TEST(Handles, OfEvents) {
  const Handles h;
  expect_refused(h, h.event, CL_INVALID_EVENT,
                 {[](void* p) { return cl.clRetainEvent(static_cast<cl_event>(p)); },
                  [](void* p) { return cl.clSetUserEventStatus(static_cast<cl_event>(p), 0); },
                  [](void* p) {
                    const auto event = static_cast<cl_event>(p);
                    return cl.clWaitForEvents(1, &event);
                  }});
  expect_refused(h, h.event, CL_INVALID_EVENT_WAIT_LIST, {[&](void* p) {
                   const auto event = static_cast<cl_event>(p);
                   return cl.clEnqueueMarkerWithWaitList(h.queue, 1, &event, nullptr);
                 }});
}

TEST(Queues, HaveNoPropertiesToChange) {
  const Rig rig(CL_DEVICE_TYPE_GPU);
  EXPECT_EQ(cl.clSetCommandQueueProperty(rig.queue, CL_QUEUE_PROFILING_ENABLE, CL_TRUE, nullptr),
            CL_INVALID_OPERATION);
  EXPECT_EQ(cl.clSetCommandQueueProperty(rig.queue, ~0ull, CL_TRUE, nullptr), CL_INVALID_VALUE);
  EXPECT_EQ(cl.clSetDefaultDeviceCommandQueue(rig.context, rig.device, rig.queue),
            CL_INVALID_OPERATION);
  EXPECT_EQ(cl.clSetDefaultDeviceCommandQueue(rig.context, nullptr, rig.queue), CL_INVALID_DEVICE);
}

}  // namespace
}  // namespace partita::mock
