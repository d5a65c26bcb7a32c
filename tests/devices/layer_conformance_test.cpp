// Behaviours that OpenCL's conformance tests look at, where the layer stands between them and PoCL.
#include <array>
#include <chrono>
#include <thread>

#include "tests/devices/layer_emulated.h"

namespace partita {
namespace {

cl_int status_of(cl_event event) {
  cl_int status = -1;
  clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, nullptr);
  return status;
}

bool ends(cl_event event) {
  for (int i = 0; i < 2000 && status_of(event) > CL_COMPLETE; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return status_of(event) == CL_COMPLETE;
}

struct SmallImage {
  explicit SmallImage(cl_context context) {
    const cl_image_format format{CL_RGBA, CL_UNSIGNED_INT8};
    cl_image_desc desc{};
    desc.image_type = CL_MEM_OBJECT_IMAGE2D;
    desc.image_width = desc.image_height = 8;
    handle = clCreateImage(context, CL_MEM_READ_WRITE, &format, &desc, nullptr, nullptr);
  }
  ~SmallImage() { clReleaseMemObject(handle); }
  SmallImage(const SmallImage&) = delete;
  SmallImage& operator=(const SmallImage&) = delete;

  cl_int write(cl_command_queue queue, std::vector<cl_event> waits, cl_event* event) {
    const std::size_t origin[3] = {0, 0, 0}, region[3] = {8, 8, 1};
    return clEnqueueWriteImage(queue, handle, CL_FALSE, origin, region, 0, 0, pixels.data(),
                               static_cast<cl_uint>(waits.size()),
                               waits.empty() ? nullptr : waits.data(), event);
  }

  cl_mem handle = nullptr;
  std::array<unsigned char, 256> pixels{};
};

TEST_F(EmulatedGpu, ImageCommandsOfAnOutOfOrderQueueOvertakeOneAnother) {
  const cl_command_queue queue =
      clCreateCommandQueue(context_, device_, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, &error_);
  SmallImage held(context_), free(context_), fenced(context_);
  const cl_event gate = clCreateUserEvent(context_, &error_);
  cl_event waiting = nullptr, passing = nullptr, behind = nullptr;
  ASSERT_EQ(held.write(queue, {gate}, &waiting), CL_SUCCESS);
  ASSERT_EQ(free.write(queue, {}, &passing), CL_SUCCESS);
  EXPECT_TRUE(ends(passing));
  EXPECT_GT(status_of(waiting), CL_COMPLETE);
  ASSERT_EQ(clEnqueueBarrierWithWaitList(queue, 0, nullptr, nullptr), CL_SUCCESS);
  ASSERT_EQ(fenced.write(queue, {}, &behind), CL_SUCCESS);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_GT(status_of(behind), CL_COMPLETE);
  clSetUserEventStatus(gate, CL_COMPLETE);
  EXPECT_EQ(clFinish(queue), CL_SUCCESS);
  EXPECT_EQ(status_of(waiting), CL_COMPLETE);
  EXPECT_EQ(status_of(behind), CL_COMPLETE);
  for (const cl_event e : {gate, waiting, passing, behind}) clReleaseEvent(e);
  clReleaseCommandQueue(queue);
}

TEST_F(EmulatedGpu, AnImageCommandFailsWithWhatItWaitsFor) {
  for (const cl_command_queue_properties order : {0, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE}) {
    const cl_command_queue queue = clCreateCommandQueue(context_, device_, order, &error_);
    SmallImage image(context_);
    const cl_event gate = clCreateUserEvent(context_, &error_);
    cl_event event = nullptr;
    ASSERT_EQ(image.write(queue, {gate}, &event), CL_SUCCESS);
    // PoCL crashes if an event fails while the command before it in the queue is just ending.
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    clSetUserEventStatus(gate, -5);
    EXPECT_EQ(clWaitForEvents(1, &event), CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST);
    EXPECT_LT(status_of(event), 0);
    for (const cl_event e : {gate, event}) clReleaseEvent(e);
    clReleaseCommandQueue(queue);
  }
}

std::vector<unsigned char> binary_of(cl_program program) {
  std::size_t size = 0;
  clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr);
  std::vector<unsigned char> bytes(size);
  unsigned char* pointer = bytes.data();
  clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof pointer, &pointer, nullptr);
  return bytes;
}

TEST_F(EmulatedGpu, ALoadedBinaryIsThereBeforeItIsBuilt) {
  ASSERT_EQ(build("__kernel void k(__global int* a) { a[0] = 1; }"), CL_SUCCESS);
  const std::vector<unsigned char> bytes = binary_of(program_);
  const std::size_t size = bytes.size();
  const unsigned char* pointer = bytes.data();
  const cl_program again =
      clCreateProgramWithBinary(context_, 1, &device_, &size, &pointer, nullptr, &error_);
  ASSERT_EQ(error_, CL_SUCCESS);
  EXPECT_EQ(binary_of(again), bytes);
  ASSERT_EQ(clBuildProgram(again, 1, &device_, "", nullptr, nullptr), CL_SUCCESS);
  EXPECT_EQ(binary_of(again), bytes);
  clReleaseProgram(again);
}

TEST_F(EmulatedGpu, HeadersComeWithTheirNames) {
  const char* text = "__kernel void k() {}";
  program_ = clCreateProgramWithSource(context_, 1, &text, nullptr, &error_);
  const char* name = "h.h";
  const char* no_name = nullptr;
  const cl_program none = nullptr;
  const auto compile = [&](cl_uint count, const cl_program* headers, const char** names) {
    return clCompileProgram(program_, 1, &device_, "", count, headers, names, nullptr, nullptr);
  };
  EXPECT_EQ(compile(1, &program_, nullptr), CL_INVALID_VALUE);
  EXPECT_EQ(compile(1, nullptr, &name), CL_INVALID_VALUE);
  EXPECT_EQ(compile(1, &program_, &no_name), CL_INVALID_VALUE);
  EXPECT_EQ(compile(0, &program_, &name), CL_INVALID_VALUE);
  EXPECT_EQ(compile(1, &none, &name), CL_INVALID_PROGRAM);
  EXPECT_EQ(clLinkProgram(context_, 0, nullptr, "", 1, &none, nullptr, nullptr, &error_), nullptr);
  EXPECT_EQ(error_, CL_INVALID_PROGRAM);
}

TEST_F(EmulatedGpu, MacrosAreThoseOfReportedExtensions) {
  EXPECT_EQ(build("#ifdef cl_khr_depth_images\n#error depth\n#endif\n"
                  "#ifdef __opencl_c_generic_address_space\n#error generic\n#endif\n"
                  "#ifndef __opencl_c_images\n#error images\n#endif\n__kernel void k() {}",
                  "-cl-std=CL3.0"),
            CL_SUCCESS)
      << log();
}

}  // namespace
}  // namespace partita
