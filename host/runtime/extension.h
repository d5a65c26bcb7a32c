// The emulation layer's extension, where there is one. On a real driver every member is null and
// every call below does nothing: the host program has no emulation branch.
#ifndef PARTITA_HOST_RUNTIME_EXTENSION_H
#define PARTITA_HOST_RUNTIME_EXTENSION_H

#include <cstdint>
#include <string>

#include "devices/work.h"
#include "host/runtime/device.h"

namespace partita::runtime {

class Extension {
 public:
  Extension() = default;
  explicit Extension(const cl::Platform& platform);

  /// Whether there is a predicted clock at all.
  bool present() const { return set_work_ != nullptr; }

  void bind_thread(const char* name, unsigned rank, const Device& near) const;
  void set_label(const char* task, std::int64_t frame) const;
  void set_work(const cl::CommandQueue& queue, const Work& work) const;
  void host_step(const char* name, const Work& work) const;
  void sensor_input(const char* name, std::uint64_t bytes) const;
  void wait_until(std::uint64_t ns) const;
  std::uint64_t host_clock() const;  ///< zero without the extension
  /// Throws Error if the record cannot be written.
  void export_record(const std::string& path) const;

 private:
  BindThreadFn bind_thread_ = nullptr;
  SetLabelFn set_label_ = nullptr;
  SetWorkFn set_work_ = nullptr;
  HostStepFn host_step_ = nullptr;
  SensorInputFn sensor_input_ = nullptr;
  WaitUntilFn wait_until_ = nullptr;
  HostClockFn host_clock_ = nullptr;
  ExportRecordFn export_record_ = nullptr;
};

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_EXTENSION_H
