// The layer's state: the emulated machine, its clock, and the side tables. One per process, made
// when the loader initialises the layer and never destroyed, because programs and drivers call
// OpenCL from destructors and from threads that outlive main.
#ifndef PARTITA_DEVICES_LAYER_STATE_H
#define PARTITA_DEVICES_LAYER_STATE_H

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include <CL/cl_icd.h>

#include "devices/layer/fault.h"
#include "devices/layer/objects.h"
#include "devices/layer/registry.h"
#include "devices/model/model.h"
#include "devices/profile/machine.h"
#include "devices/timeline/timeline.h"

namespace partita::layer {

struct Platform;

/// An emulated device. Its handle is that of a sub-device of the driver's CPU device.
struct Device {
  Device(const profile::MachineDevice& machine_device, std::uint32_t device_index);

  const profile::MachineDevice& machine;
  const profile::DeviceProfile& profile;
  const profile::OpenclIdentity& cl;
  model::DeviceModel model;
  std::uint32_t index;  ///< timeline::DeviceId
  Platform* platform = nullptr;
  cl_device_id handle = nullptr;
  std::vector<std::string> extensions;
  cl_version version = 0;    ///< of CL_DEVICE_VERSION
  cl_version c_version = 0;  ///< of CL_DEVICE_OPENCL_C_VERSION
  FaultState fault;

  std::atomic<std::uint64_t> allocated{0};  ///< bytes of its memory that programs hold
  // The FPGA's configuration: what is loaded, and what still uses it.
  std::weak_ptr<LoadedContainer> container;
  std::uint64_t loaded = 0;  ///< fingerprint; 0: nothing was loaded yet

  bool is_fpga() const { return profile.type == profile::DeviceType::fpga; }
  bool has(std::string_view extension) const;
};

/// A vendor's platform. Programs hold pointers to it as cl_platform_id; as every ICD object it
/// begins with a dispatch table.
struct Platform {
  const cl_icd_dispatch* dispatch = nullptr;
  const profile::OpenclIdentity* cl = nullptr;
  cl_version version = 0;
  std::vector<Device*> devices;

  cl_platform_id handle() { return reinterpret_cast<cl_platform_id>(this); }
};

struct State {
  std::mutex mutex;  ///< guards everything below `mutex`; never held while the driver is called

  profile::Machine machine;
  std::vector<std::unique_ptr<Device>> devices;
  std::vector<std::unique_ptr<Platform>> platforms;
  std::vector<model::DeviceModel> hosts;  ///< of the nodes' CPUs, for host steps
  std::string problem;                    ///< why there is no machine; empty: there is one
  cl_platform_id real_platform = nullptr;
  cl_device_id real_device = nullptr;
  std::once_flag opened;

  bool allow_source = false;  ///< PARTITA_ALLOW_SOURCE: an FPGA takes source
  bool recording = false;     ///< PARTITA_RECORD or PARTITA_RECORDING
  bool verbose = false;       ///< PARTITA_VERBOSE

  std::unique_ptr<timeline::Timeline> timeline;
  Registry<cl_context, Context> contexts;
  Registry<cl_command_queue, Queue> queues;
  Registry<cl_program, Program> programs;
  Registry<cl_kernel, Kernel> kernels;
  Registry<cl_mem, Memory> memories;
  Registry<cl_sampler, Sampler> samplers;
  std::unordered_map<cl_event, Event> events;
};

State& state();
using Lock = std::lock_guard<std::mutex>;

/// The dispatch table below the layer: the loader's, or a mock.
const cl_icd_dispatch& target();
void set_target(const cl_icd_dispatch& table, std::size_t entries);

/// Reads PARTITA_MACHINE and the other variables; called once, before any driver starts. A machine
/// that cannot be read leaves its one line in state().problem.
void read_environment();

/// Finds the driver's CPU device and splits it, at the first call; true if the machine is there.
/// Otherwise says why, once, on stderr.
bool open_machine();

Device* find_device(cl_device_id handle);
Platform* find_platform(cl_platform_id handle);

/// One line on stderr: "partita: ...".
void say(const std::string& line);
/// The same only with PARTITA_VERBOSE, and once per text.
void say_once(const std::string& line);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_STATE_H
