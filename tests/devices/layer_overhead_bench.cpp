// What the layer adds to an enqueued command, in wall time. The program runs itself as a child,
// alternately on PoCL alone (on a sub-device of one compute unit, as the layer gives) and under
// the layer, and compares the medians.
//
//   layer_overhead_bench LAYER PROFILES [ROUNDS]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "devices/work.h"

namespace {

using partita::Work;

constexpr int kBatch = 1000;
constexpr int kBatches = 40;

double now_ns() {
  return static_cast<double>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                 std::chrono::steady_clock::now().time_since_epoch())
                                 .count());
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

void check(cl_int error, const char* what) {
  if (error == CL_SUCCESS) return;
  std::fprintf(stderr, "%s: error %d\n", what, error);
  std::exit(1);
}

cl_device_id pick_device(bool layer) {
  cl_uint count = 0;
  check(clGetPlatformIDs(0, nullptr, &count), "clGetPlatformIDs");
  std::vector<cl_platform_id> platforms(count);
  clGetPlatformIDs(count, platforms.data(), nullptr);
  for (const cl_platform_id p : platforms) {
    char name[128] = "";
    clGetPlatformInfo(p, CL_PLATFORM_NAME, sizeof name, name, nullptr);
    cl_device_id device = nullptr;
    const cl_device_type type = layer ? CL_DEVICE_TYPE_GPU : CL_DEVICE_TYPE_CPU;
    if ((!layer && std::strstr(name, "Portable") == nullptr) ||
        clGetDeviceIDs(p, type, 1, &device, nullptr) != CL_SUCCESS) {
      continue;
    }
    if (layer) return device;
    const cl_device_partition_property one[] = {CL_DEVICE_PARTITION_BY_COUNTS, 1,
                                                CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    cl_device_id part = nullptr;
    check(clCreateSubDevices(device, one, 1, &part, nullptr), "clCreateSubDevices");
    return part;
  }
  std::fprintf(stderr, "no device\n");
  std::exit(1);
}

/// Prints "enqueue_ns whole_ns": the median call, and a batch with its end divided by its size.
int child(bool layer, bool with_event) {
  const cl_device_id device = pick_device(layer);
  cl_int error = CL_SUCCESS;
  const cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &error);
  check(error, "clCreateContext");
  const cl_command_queue queue =
      clCreateCommandQueue(context, device, CL_QUEUE_PROFILING_ENABLE, &error);
  check(error, "clCreateCommandQueue");
  const char* text = "__kernel void k(__global int* a) { a[get_global_id(0)] += 1; }";
  const cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, &error);
  check(clBuildProgram(program, 0, nullptr, "-cl-std=CL1.2", nullptr, nullptr), "build");
  const cl_kernel kernel = clCreateKernel(program, "k", &error);
  const cl_mem buffer = clCreateBuffer(context, CL_MEM_READ_WRITE, 64, nullptr, &error);
  check(clSetKernelArg(kernel, 0, sizeof buffer, &buffer), "clSetKernelArg");
  cl_platform_id platform = nullptr;
  clGetDeviceInfo(device, CL_DEVICE_PLATFORM, sizeof platform, &platform, nullptr);
  const auto set_work = reinterpret_cast<partita::SetWorkFn>(
      clGetExtensionFunctionAddressForPlatform(platform, partita::kSetWork));
  Work work;
  work.read_unique = work.written_unique = 16;
  const std::size_t global = 4, local = 4;
  std::vector<double> calls, wholes;
  std::vector<cl_event> events(kBatch);
  for (int b = 0; b < kBatches; ++b) {
    const double begin = now_ns();
    for (int i = 0; i < kBatch; ++i) {
      const double before = now_ns();
      if (set_work) set_work(queue, &work);
      check(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &global, &local, 0, nullptr,
                                   with_event ? &events[i] : nullptr),
            "clEnqueueNDRangeKernel");
      calls.push_back(now_ns() - before);
    }
    clFinish(queue);
    wholes.push_back((now_ns() - begin) / kBatch);
    for (int i = 0; with_event && i < kBatch; ++i) clReleaseEvent(events[i]);
  }
  std::printf("%.0f %.0f\n", median(calls), median(wholes));
  return 0;
}

struct Figures {
  double call = 0, whole = 0;
};

Figures run_child(const std::string& command) {
  Figures f;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe || std::fscanf(pipe, "%lf %lf", &f.call, &f.whole) != 2) {
    std::fprintf(stderr, "failed: %s\n", command.c_str());
    std::exit(1);
  }
  pclose(pipe);
  return f;
}

void compare(const std::string& self, const std::string& layer, const std::string& profiles,
             int rounds, const std::string& mode) {
  std::vector<double> call[2], whole[2];
  for (int r = 0; r < rounds; ++r) {
    const Figures bare =
        run_child("env -u OPENCL_LAYERS -u PARTITA_MACHINE " + self + " --child bare " + mode);
    const Figures with = run_child("env OPENCL_LAYERS=" + layer + " PARTITA_PROFILES=" + profiles +
                                   " PARTITA_MACHINE=gpu-only " + self + " --child layer " + mode);
    call[0].push_back(bare.call), whole[0].push_back(bare.whole);
    call[1].push_back(with.call), whole[1].push_back(with.whole);
  }
  std::printf("%-8s call:  PoCL %6.0f ns  layer %6.0f ns  added %6.0f ns\n", mode.c_str(),
              median(call[0]), median(call[1]), median(call[1]) - median(call[0]));
  std::printf("%-8s batch: PoCL %6.0f ns  layer %6.0f ns  added %6.0f ns per command\n",
              mode.c_str(), median(whole[0]), median(whole[1]),
              median(whole[1]) - median(whole[0]));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::strcmp(argv[1], "--child") == 0) {
    return child(std::strcmp(argv[2], "layer") == 0, std::strcmp(argv[3], "event") == 0);
  }
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s LAYER PROFILES [ROUNDS]\n", argv[0]);
    return 2;
  }
  const int rounds = argc > 3 ? std::atoi(argv[3]) : 5;
  for (const char* mode : {"plain", "event"}) compare(argv[0], argv[1], argv[2], rounds, mode);
  return 0;
}
