// A program with two threads and two devices that prints its record's replay: every command's
// predicted times. Two runs must print the same.
//
//   layer_probe RECORD
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "devices/timeline/schedule.h"
#include "devices/work.h"

namespace {

using namespace partita;

cl_device_id device_of(cl_device_type type) {
  cl_platform_id platforms[8];
  cl_uint count = 0;
  clGetPlatformIDs(8, platforms, &count);
  for (cl_uint i = 0; i < count; ++i) {
    cl_device_id device = nullptr;
    if (clGetDeviceIDs(platforms[i], type, 1, &device, nullptr) == CL_SUCCESS) return device;
  }
  return nullptr;
}

template <typename F>
F extension(cl_device_id device, const char* name) {
  cl_platform_id platform = nullptr;
  clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, &platform, nullptr);
  return reinterpret_cast<F>(clGetExtensionFunctionAddressForPlatform(platform, name));
}

void act(cl_device_id device, const char* name, cl_uint rank) {
  extension<BindThreadFn>(device, kBindThread)(name, rank, device);
  const cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, nullptr);
  const cl_command_queue queue = clCreateCommandQueue(context, device, 0, nullptr);
  const char* text = "__kernel void add(__global int* a) { a[get_global_id(0)] += 1; }";
  const cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, nullptr);
  clBuildProgram(program, 0, nullptr, "", nullptr, nullptr);
  const cl_kernel kernel = clCreateKernel(program, "add", nullptr);
  const cl_mem buffer = clCreateBuffer(context, CL_MEM_READ_WRITE, 1 << 16, nullptr, nullptr);
  clSetKernelArg(kernel, 0, sizeof buffer, &buffer);
  std::vector<char> host(1 << 16);
  for (int frame = 0; frame < 20; ++frame) {
    extension<SetLabelFn>(device, kSetLabel)(name, frame);
    extension<WaitUntilFn>(device, kWaitUntil)(static_cast<cl_ulong>(frame) * 1'000'000);
    clEnqueueWriteBuffer(queue, buffer, CL_FALSE, 0, host.size(), host.data(), 0, nullptr, nullptr);
    Work work;
    work[OpClass::int_add] = 40'000'000;
    work.read_unique = work.written_unique = 1 << 20;
    const std::size_t global = 1 << 14;
    for (int k = 0; k < 3; ++k) {
      if (k < 2) extension<SetWorkFn>(device, kSetWork)(queue, &work);  // the third is estimated
      clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &global, nullptr, 0, nullptr, nullptr);
    }
    clEnqueueReadBuffer(queue, buffer, CL_TRUE, 0, host.size(), host.data(), 0, nullptr, nullptr);
    work.kind = WorkKind::serial;
    extension<HostStepFn>(device, kHostStep)("solve", &work);
  }
  clFinish(queue);
  clReleaseMemObject(buffer);
  clReleaseKernel(kernel);
  clReleaseProgram(program);
  clReleaseCommandQueue(queue);
  clReleaseContext(context);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const cl_device_id gpu = device_of(CL_DEVICE_TYPE_GPU), cpu = device_of(CL_DEVICE_TYPE_CPU);
  if (!gpu || !cpu) return 3;
  // Bound first, from here: the first binding begins the record.
  extension<BindThreadFn>(gpu, kBindThread)("main", 9, nullptr);
  std::thread scene(act, gpu, "scene", 1), localization(act, cpu, "localization", 0);
  scene.join();
  localization.join();
  if (extension<ExportRecordFn>(gpu, kExportRecord)(argv[1]) != CL_SUCCESS) return 4;
  const timeline::Record record = timeline::load_record(argv[1]);
  const timeline::Schedule schedule = timeline::replay(record);
  std::size_t measured = 0;
  // The order in the record is the race's; the content of a task's frame is not.
  std::vector<std::string> lines;
  for (const timeline::ScheduledCommand& c : schedule.commands) {
    const timeline::RecordedCommand& r = record.commands[c.command];
    measured += r.measured_end > r.measured_start ? 1 : 0;
    char line[256];
    std::snprintf(line, sizeof line, "%s %lld %llu %llu %llu %llu", record.names[r.task].c_str(),
                  static_cast<long long>(r.frame), static_cast<unsigned long long>(c.times.queued),
                  static_cast<unsigned long long>(c.times.submit),
                  static_cast<unsigned long long>(c.times.start),
                  static_cast<unsigned long long>(c.times.end));
    lines.push_back(line);
  }
  std::sort(lines.begin(), lines.end());
  for (const std::string& line : lines) std::puts(line.c_str());
  if (measured < 100) return 5;  // 5 commands a frame ran here, on two devices
  return 0;
}
