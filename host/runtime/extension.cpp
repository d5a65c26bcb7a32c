#include "host/runtime/extension.h"

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::runtime {
namespace {

template <typename Function>
Function find(const cl::Platform& platform, const char* name) {
  return reinterpret_cast<Function>(clGetExtensionFunctionAddressForPlatform(platform(), name));
}

}  // namespace

Extension::Extension(const cl::Platform& platform)
    : bind_thread_(find<BindThreadFn>(platform, kBindThread)),
      set_label_(find<SetLabelFn>(platform, kSetLabel)),
      set_work_(find<SetWorkFn>(platform, kSetWork)),
      host_step_(find<HostStepFn>(platform, kHostStep)),
      sensor_input_(find<SensorInputFn>(platform, kSensorInput)),
      wait_until_(find<WaitUntilFn>(platform, kWaitUntil)),
      host_clock_(find<HostClockFn>(platform, kHostClock)),
      export_record_(find<ExportRecordFn>(platform, kExportRecord)) {}

void Extension::bind_thread(const char* name, unsigned rank, const Device& near) const {
  if (bind_thread_ != nullptr) bind_thread_(name, rank, near.cl());
}

void Extension::set_label(const char* task, std::int64_t frame) const {
  if (set_label_ != nullptr) set_label_(task, frame);
}

void Extension::set_work(const cl::CommandQueue& queue, const Work& work) const {
  if (set_work_ != nullptr) set_work_(queue(), &work);
}

void Extension::host_step(const char* name, const Work& work) const {
  if (host_step_ != nullptr) host_step_(name, &work);
}

void Extension::sensor_input(const char* name, std::uint64_t bytes) const {
  if (sensor_input_ != nullptr) sensor_input_(name, bytes);
}

void Extension::wait_until(std::uint64_t ns) const {
  if (wait_until_ != nullptr) wait_until_(ns);
}

std::uint64_t Extension::host_clock() const {
  cl_ulong ns = 0;
  if (host_clock_ != nullptr) host_clock_(&ns);
  return ns;
}

void Extension::export_record(const std::string& path) const {
  if (export_record_ == nullptr) return;
  const cl_int code = export_record_(path.c_str());
  if (code != CL_SUCCESS) {
    throw Error(
        fmt::format("{}: the record of the run could not be written ({})", path, error_name(code)));
  }
}

}  // namespace partita::runtime
