#include "tests/devices/layer_mock.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include <CL/cl_layer.h>

#include "devices/layer/answer.h"

namespace partita::mock {
namespace {

using layer::Answer;

std::mutex mutex;
std::atomic<std::int64_t> objects{0};

struct Object {
  const cl_icd_dispatch* dispatch = &driver();
  std::atomic<int> references{1};
  Object* parent = nullptr;
  std::string text;  ///< program: source; kernel: name
  bool built = false;
  std::size_t bytes = 0;  ///< memory
  // Events:
  cl_int status = CL_COMPLETE;
  int waits_for = 0;
  bool user = false;
  std::vector<Object*> dependents;
  std::vector<std::function<void(cl_int)>> callbacks;

  explicit Object(Object* from = nullptr) : parent(from) {
    ++objects;
    if (parent) ++parent->references;
  }
};

void release(Object* o) {
  if (--o->references != 0) return;
  if (o->parent) release(o->parent);
  delete o;
  --objects;
}

template <typename Handle>
Object* object(Handle h) {
  return reinterpret_cast<Object*>(h);
}
template <typename Handle>
Handle handle(Object* o, cl_int* error = nullptr) {
  if (error) *error = CL_SUCCESS;
  return reinterpret_cast<Handle>(o);
}
template <typename Handle>
cl_int CL_API_CALL retain_it(Handle h) {
  ++object(h)->references;
  return CL_SUCCESS;
}
template <typename Handle>
cl_int CL_API_CALL release_it(Handle h) {
  release(object(h));
  return CL_SUCCESS;
}

struct FixedObjects {
  Object platform, device;
  std::vector<Object*> parts;
};
FixedObjects& fixed() {
  static auto* const f = new FixedObjects;
  return *f;
}

/// Completes an event and, through it, what waits for it. The mutex is held; callbacks are
/// gathered, to run without it.
void complete(Object* event, cl_int status, std::vector<std::function<void()>>& run) {
  event->status = status;
  for (auto& callback : event->callbacks) run.push_back([callback, status] { callback(status); });
  event->callbacks.clear();
  for (Object* d : event->dependents) {
    if (--d->waits_for == 0) complete(d, status < 0 ? status : CL_COMPLETE, run);
    release(d);
  }
  event->dependents.clear();
}

cl_int enqueue(cl_command_queue queue, cl_uint count, const cl_event* waits, cl_event* event) {
  if ((count == 0) != (waits == nullptr)) return CL_INVALID_EVENT_WAIT_LIST;
  const std::lock_guard lock(mutex);
  auto* made = new Object(object(queue));
  for (cl_uint i = 0; i < count; ++i) {
    Object* w = object(waits[i]);
    if (w->status <= CL_COMPLETE) continue;
    ++made->waits_for;
    ++made->references;
    w->dependents.push_back(made);
  }
  if (made->waits_for) made->status = CL_QUEUED;
  if (event) {
    *event = handle<cl_event>(made);
  } else {
    release(made);
  }
  return CL_SUCCESS;
}

void add_queries(cl_icd_dispatch& t) {
  t.clGetPlatformIDs = [](cl_uint n, cl_platform_id* p, cl_uint* count) -> cl_int {
    if (p && n) *p = handle<cl_platform_id>(&fixed().platform);
    if (count) *count = 1;
    return CL_SUCCESS;
  };
  t.clGetPlatformInfo = [](cl_platform_id, cl_platform_info, std::size_t n, void* v,
                           std::size_t* r) -> cl_int {
    return Answer(n, v, r).put_text("Portable Computing Language");
  };
  t.clGetDeviceIDs = [](cl_platform_id, cl_device_type, cl_uint, cl_device_id* d,
                        cl_uint* count) -> cl_int {
    if (d) *d = handle<cl_device_id>(&fixed().device);
    if (count) *count = 1;
    return CL_SUCCESS;
  };
  t.clGetDeviceInfo = [](cl_device_id, cl_device_info name, std::size_t n, void* v,
                         std::size_t* r) -> cl_int {
    const Answer a(n, v, r);
    if (name == CL_DEVICE_MAX_COMPUTE_UNITS) return a.put<cl_uint>(4);
    if (name == CL_DEVICE_EXTENSIONS) return a.put_text("cl_khr_fp64 cl_mock_only");
    if (name == CL_DEVICE_OPENCL_C_FEATURES) return a.put_bytes(nullptr, 0);
    return CL_INVALID_VALUE;
  };
  t.clCreateSubDevices = [](cl_device_id, const cl_device_partition_property*, cl_uint n,
                            cl_device_id* out, cl_uint*) -> cl_int {
    for (cl_uint i = 0; i < n; ++i) {
      fixed().parts.push_back(new Object);
      out[i] = handle<cl_device_id>(fixed().parts.back());
    }
    return CL_SUCCESS;
  };
}

void add_objects(cl_icd_dispatch& t) {
  t.clCreateContext = [](const cl_context_properties*, cl_uint, const cl_device_id*,
                         void(CL_CALLBACK*)(const char*, const void*, std::size_t, void*), void*,
                         cl_int* e) { return handle<cl_context>(new Object, e); };
  t.clCreateCommandQueue = [](cl_context c, cl_device_id, cl_command_queue_properties, cl_int* e) {
    return handle<cl_command_queue>(new Object(object(c)), e);
  };
  t.clCreateCommandQueueWithProperties = [](cl_context c, cl_device_id, const cl_queue_properties*,
                                            cl_int* e) {
    return handle<cl_command_queue>(new Object(object(c)), e);
  };
  t.clCreateBuffer = [](cl_context c, cl_mem_flags, std::size_t bytes, void*, cl_int* e) {
    auto* o = new Object(object(c));
    o->bytes = bytes;
    return handle<cl_mem>(o, e);
  };
  t.clCreateSubBuffer = [](cl_mem m, cl_mem_flags, cl_buffer_create_type, const void*, cl_int* e) {
    return handle<cl_mem>(new Object(object(m)), e);
  };
  t.clRetainContext = retain_it, t.clReleaseContext = release_it;
  t.clRetainCommandQueue = retain_it, t.clReleaseCommandQueue = release_it;
  t.clRetainMemObject = retain_it, t.clReleaseMemObject = release_it;
  t.clRetainProgram = retain_it, t.clReleaseProgram = release_it;
  t.clRetainKernel = retain_it, t.clReleaseKernel = release_it;
  t.clRetainEvent = retain_it, t.clReleaseEvent = release_it;
}

void add_programs(cl_icd_dispatch& t) {
  t.clCreateProgramWithSource = [](cl_context c, cl_uint, const char** s, const std::size_t* n,
                                   cl_int* e) {
    auto* o = new Object(object(c));
    o->text.assign(s[0], n[0]);
    return handle<cl_program>(o, e);
  };
  t.clCreateProgramWithBinary = [](cl_context c, cl_uint, const cl_device_id*, const std::size_t* n,
                                   const unsigned char** b, cl_int* status, cl_int* e) {
    auto* o = new Object(object(c));
    o->text.assign(reinterpret_cast<const char*>(b[0]), n[0]);
    if (status) *status = CL_SUCCESS;
    return handle<cl_program>(o, e);
  };
  t.clBuildProgram = [](cl_program p, cl_uint, const cl_device_id*, const char*,
                        void(CL_CALLBACK*)(cl_program, void*), void*) -> cl_int {
    object(p)->built = object(p)->text.find("syntax error") == std::string::npos;
    return object(p)->built ? CL_SUCCESS : CL_BUILD_PROGRAM_FAILURE;
  };
  t.clGetProgramBuildInfo = [](cl_program, cl_device_id, cl_program_build_info, std::size_t n,
                               void* v, std::size_t* r) -> cl_int {
    return Answer(n, v, r).put_text("the mock's log");
  };
  t.clGetProgramInfo = [](cl_program p, cl_program_info name, std::size_t n, void* v,
                          std::size_t* r) -> cl_int {
    const std::string& text = object(p)->text;
    if (name == CL_PROGRAM_BINARY_SIZES) return Answer(n, v, r).put<std::size_t>(text.size());
    if (name != CL_PROGRAM_BINARIES) return CL_INVALID_VALUE;
    std::memcpy(*static_cast<char**>(v), text.data(), text.size());
    return CL_SUCCESS;
  };
}

void add_kernels(cl_icd_dispatch& t) {
  t.clCreateKernel = [](cl_program p, const char* name, cl_int* e) -> cl_kernel {
    if (!object(p)->built) {
      *e = CL_INVALID_PROGRAM_EXECUTABLE;
      return nullptr;
    }
    auto* o = new Object(object(p));
    o->text = name;
    return handle<cl_kernel>(o, e);
  };
  t.clGetKernelInfo = [](cl_kernel k, cl_kernel_info name, std::size_t n, void* v,
                         std::size_t* r) -> cl_int {
    const Answer a(n, v, r);
    if (name == CL_KERNEL_FUNCTION_NAME) return a.put_text(object(k)->text);
    if (name == CL_KERNEL_NUM_ARGS) return a.put<cl_uint>(2);
    return CL_INVALID_VALUE;
  };
  t.clGetKernelArgInfo = [](cl_kernel, cl_uint i, cl_kernel_arg_info name, std::size_t n, void* v,
                            std::size_t* r) -> cl_int {
    if (name != CL_KERNEL_ARG_ADDRESS_QUALIFIER) return CL_INVALID_VALUE;
    return Answer(n, v, r).put<cl_kernel_arg_address_qualifier>(
        i == 0 ? CL_KERNEL_ARG_ADDRESS_GLOBAL : CL_KERNEL_ARG_ADDRESS_LOCAL);
  };
  t.clGetKernelWorkGroupInfo = [](cl_kernel k, cl_device_id, cl_kernel_work_group_info name,
                                  std::size_t n, void* v, std::size_t* r) -> cl_int {
    const Answer a(n, v, r);
    const std::size_t required = object(k)->text == "task" ? 1 : 0;
    switch (name) {
      case CL_KERNEL_COMPILE_WORK_GROUP_SIZE:
        return a.put(std::array<std::size_t, 3>{required, required, required});
      case CL_KERNEL_LOCAL_MEM_SIZE:
        return a.put<cl_ulong>(object(k)->text == "wide_local" ? 40000 : 0);
      case CL_KERNEL_WORK_GROUP_SIZE:
        return a.put<std::size_t>(4096);
      default:
        return CL_INVALID_VALUE;
    }
  };
  t.clSetKernelArg = [](cl_kernel, cl_uint, std::size_t, const void*) -> cl_int {
    return CL_SUCCESS;
  };
}

void add_commands(cl_icd_dispatch& t) {
  t.clEnqueueNDRangeKernel = [](cl_command_queue q, cl_kernel, cl_uint, const std::size_t*,
                                const std::size_t*, const std::size_t*, cl_uint n,
                                const cl_event* w, cl_event* e) { return enqueue(q, n, w, e); };
  t.clEnqueueReadBuffer = [](cl_command_queue q, cl_mem, cl_bool, std::size_t, std::size_t, void*,
                             cl_uint n, const cl_event* w,
                             cl_event* e) { return enqueue(q, n, w, e); };
  t.clEnqueueWriteBuffer = [](cl_command_queue q, cl_mem, cl_bool, std::size_t, std::size_t,
                              const void*, cl_uint n, const cl_event* w,
                              cl_event* e) { return enqueue(q, n, w, e); };
  t.clEnqueueMarkerWithWaitList = [](cl_command_queue q, cl_uint n, const cl_event* w,
                                     cl_event* e) { return enqueue(q, n, w, e); };
  t.clEnqueueMapBuffer = [](cl_command_queue q, cl_mem m, cl_bool, cl_map_flags, std::size_t,
                            std::size_t, cl_uint n, const cl_event* w, cl_event* e,
                            cl_int* error) -> void* {
    *error = enqueue(q, n, w, e);
    return object(m);
  };
  t.clEnqueueUnmapMemObject = [](cl_command_queue q, cl_mem, void*, cl_uint n, const cl_event* w,
                                 cl_event* e) { return enqueue(q, n, w, e); };
  t.clFinish = [](cl_command_queue) -> cl_int { return CL_SUCCESS; };
}

void add_events(cl_icd_dispatch& t) {
  t.clWaitForEvents = [](cl_uint n, const cl_event* list) -> cl_int {
    const std::lock_guard lock(mutex);
    for (cl_uint i = 0; i < n; ++i) {
      if (object(list[i])->status < 0) return CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST;
    }
    return CL_SUCCESS;
  };
  t.clCreateUserEvent = [](cl_context c, cl_int* e) {
    auto* o = new Object(object(c));
    o->user = true;
    o->status = CL_SUBMITTED;
    return handle<cl_event>(o, e);
  };
  t.clSetUserEventStatus = [](cl_event event, cl_int status) -> cl_int {
    std::vector<std::function<void()>> run;
    {
      const std::lock_guard lock(mutex);
      complete(object(event), status, run);
    }
    for (auto& r : run) r();
    return CL_SUCCESS;
  };
  t.clGetEventInfo = [](cl_event event, cl_event_info name, std::size_t n, void* v,
                        std::size_t* r) -> cl_int {
    const std::lock_guard lock(mutex);
    if (name == CL_EVENT_REFERENCE_COUNT) {
      return Answer(n, v, r).put<cl_uint>(static_cast<cl_uint>(object(event)->references));
    }
    return Answer(n, v, r).put<cl_int>(object(event)->status);
  };
  t.clSetEventCallback = [](cl_event event, cl_int, void(CL_CALLBACK * f)(cl_event, cl_int, void*),
                            void* data) -> cl_int {
    {
      const std::lock_guard lock(mutex);
      if (object(event)->status > CL_COMPLETE) {
        object(event)->callbacks.push_back([=](cl_int status) { f(event, status, data); });
        return CL_SUCCESS;
      }
    }
    f(event, object(event)->status, data);
    return CL_SUCCESS;
  };
}

}  // namespace

const cl_icd_dispatch& driver() {
  static const cl_icd_dispatch table = [] {
    cl_icd_dispatch t{};
    add_queries(t);
    add_objects(t);
    add_programs(t);
    add_kernels(t);
    add_commands(t);
    add_events(t);
    return t;
  }();
  return table;
}

std::int64_t live_objects() {
  return objects;
}

const cl_icd_dispatch& layer() {
  static const cl_icd_dispatch* const table = [] {
    const cl_icd_dispatch* made = nullptr;
    cl_uint entries = 0;
    clInitLayer(sizeof(cl_icd_dispatch) / sizeof(void*), &driver(), &entries, &made);
    return made;
  }();
  return *table;
}

}  // namespace partita::mock
