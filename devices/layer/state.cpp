#include "devices/layer/state.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <set>
#include <thread>
#include <unistd.h>

#include "devices/layer/driver_limits.h"
#include "devices/layer/record.h"
#include "devices/layer/version.h"

namespace partita::layer {
namespace {

cl_icd_dispatch target_table{};

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// PoCL makes as many compute units as this says: one for each emulated device is best. Too late if
/// the loader has started PoCL already (ocl-icd sorts platforms by their devices); then devices
/// share units.
void ask_for_compute_units(std::size_t devices) {
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  const std::string given = variable("POCL_MAX_PTHREAD_COUNT");
  const std::size_t wanted = given.empty() ? cores : std::strtoul(given.c_str(), nullptr, 10);
  setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(std::max(wanted, devices)).c_str(), 1);
}

Platform& platform_for(State& s, const profile::OpenclIdentity& cl) {
  for (auto& p : s.platforms) {
    if (p->cl->platform_name == cl.platform_name) return *p;
  }
  auto platform = std::make_unique<Platform>();
  platform->dispatch = &target_table;
  platform->cl = &cl;
  platform->version = parse_version(cl.platform_version, "OpenCL ");
  s.platforms.push_back(std::move(platform));
  return *s.platforms.back();
}

void make_devices(State& s) {
  for (std::uint32_t i = 0; i < s.machine.devices.size(); ++i) {
    auto device = std::make_unique<Device>(s.machine.devices[i], i);
    Platform& platform = platform_for(s, device->cl);
    device->platform = &platform;
    platform.devices.push_back(device.get());
    s.devices.push_back(std::move(device));
  }
  if (s.devices.empty()) throw profile::Error("machine '" + s.machine.id + "' has no device");
}

void add_faults(State& s) {
  for (const Fault& fault : parse_faults(variable("PARTITA_FAULT"))) {
    const auto it = std::find_if(s.devices.begin(), s.devices.end(),
                                 [&](const auto& d) { return d->machine.name == fault.device; });
    if (it == s.devices.end()) {
      std::string names;
      for (const auto& d : s.devices) names += (names.empty() ? "" : ", ") + d->machine.name;
      throw profile::Error("PARTITA_FAULT: no device '" + fault.device + "', expected one of " +
                           names);
    }
    (*it)->fault.add(fault);
  }
}

bool has_cpu_device(cl_platform_id platform, cl_device_id& device) {
  return target_table.clGetDeviceIDs(platform, CL_DEVICE_TYPE_CPU, 1, &device, nullptr) ==
         CL_SUCCESS;
}

bool is_pocl(cl_platform_id platform) {
  char name[128] = "";
  target_table.clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof name, name, nullptr);
  return std::strcmp(name, "Portable Computing Language") == 0;
}

void find_real_device(State& s) {
  cl_uint count = 0;
  target_table.clGetPlatformIDs(0, nullptr, &count);
  std::vector<cl_platform_id> platforms(count);
  if (count) target_table.clGetPlatformIDs(count, platforms.data(), nullptr);
  for (const cl_platform_id platform : platforms) {
    if (is_pocl(platform) && has_cpu_device(platform, s.real_device)) {
      s.real_platform = platform;
      return;
    }
  }
  throw profile::Error("no PoCL CPU device to run on, expected the package pocl-opencl-icd");
}

/// Sub-devices of the given numbers of compute units.
std::vector<cl_device_id> split(cl_device_id device, const std::vector<cl_uint>& shares) {
  std::vector<cl_device_partition_property> properties{CL_DEVICE_PARTITION_BY_COUNTS};
  properties.insert(properties.end(), shares.begin(), shares.end());
  properties.insert(properties.end(), {CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0});
  std::vector<cl_device_id> parts(shares.size());
  const cl_int error = target_table.clCreateSubDevices(
      device, properties.data(), static_cast<cl_uint>(parts.size()), parts.data(), nullptr);
  if (error != CL_SUCCESS) {
    throw profile::Error("PoCL's device cannot be split: error " + std::to_string(error));
  }
  return parts;
}

/// Deals the compute units out evenly, one sub-device for each emulated device. With fewer units
/// than devices it splits the device several times over, and devices share units.
void split_real_device(State& s) {
  cl_uint units = 0;
  target_table.clGetDeviceInfo(s.real_device, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units,
                               nullptr);
  const auto count = static_cast<cl_uint>(s.devices.size());
  if (units == 0) throw profile::Error("PoCL's device shows no compute unit");
  for (cl_uint first = 0; first < count; first += std::min(units, count)) {
    std::vector<cl_uint> shares;
    for (cl_uint i = 0; i < std::min(units, count); ++i) {
      shares.push_back(units >= count ? units / count + (i < units % count ? 1 : 0) : 1);
    }
    const std::vector<cl_device_id> parts = split(s.real_device, shares);
    for (cl_uint i = 0; i < parts.size(); ++i) {
      if (first + i < count) {
        s.devices[first + i]->handle = parts[i];
      } else {
        target_table.clReleaseDevice(parts[i]);
      }
    }
  }
}

void open_once(State& s) noexcept {
  try {
    if (s.problem.empty()) {
      find_real_device(s);
      clamp_to_driver(s);
      split_real_device(s);
      write_record_at_exit();
      return;
    }
  } catch (const std::exception& error) {
    s.problem = error.what();
  }
  s.real_platform = nullptr;
  say(s.problem);
}

}  // namespace

State& state() {
  static State* const s = new State;
  return *s;
}

const cl_icd_dispatch& target() {
  return target_table;
}

void set_target(const cl_icd_dispatch& table, std::size_t entries) {
  const std::size_t bytes = std::min(entries * sizeof(void*), sizeof target_table);
  std::memcpy(&target_table, &table, bytes);
}

void read_environment() {
  State& s = state();
  s.allow_source = variable("PARTITA_ALLOW_SOURCE") == "1";
  s.verbose = !variable("PARTITA_VERBOSE").empty();
  s.recording = !variable("PARTITA_RECORD").empty() || variable("PARTITA_RECORDING") == "1";
  try {
    s.machine = profile::load_machine(variable("PARTITA_MACHINE"), variable("PARTITA_PROFILES"));
    make_devices(s);
    for (const profile::Node& node : s.machine.nodes) s.hosts.emplace_back(node.host);
    add_faults(s);
    timeline::Options options;
    options.record = s.recording;
    s.timeline = std::make_unique<timeline::Timeline>(timeline::make_layout(s.machine), options);
    ask_for_compute_units(s.devices.size());
  } catch (const std::exception& error) {
    s.problem = error.what();
  }
}

bool open_machine() {
  State& s = state();
  std::call_once(s.opened, [&s] { open_once(s); });
  return s.problem.empty();
}

Device* find_device(cl_device_id handle) {
  if (!handle || !open_machine()) return nullptr;
  for (const auto& device : state().devices) {
    if (device->handle == handle) return device.get();
  }
  return nullptr;
}

Platform* find_platform(cl_platform_id handle) {
  if (!open_machine()) return nullptr;
  for (const auto& platform : state().platforms) {
    if (platform->handle() == handle) return platform.get();
  }
  return nullptr;
}

Device::Device(const profile::MachineDevice& machine_device, std::uint32_t device_index)
    : machine(machine_device),
      profile(machine_device.profile),
      cl(machine_device.profile.opencl),
      model(machine_device.profile),
      index(device_index),
      extensions(split_words(cl.extensions)),
      version(parse_version(cl.device_version, "OpenCL ")),
      c_version(parse_version(cl.c_version, "OpenCL C ")) {}

bool Device::has(std::string_view extension) const {
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

Memory::~Memory() {
  for (Device* device : charged) device->allocated -= bytes;
}

void say(const std::string& line) {
  const std::string text = "partita: " + line + "\n";
  if (write(STDERR_FILENO, text.data(), text.size()) < 0) return;
}

void say_once(const std::string& line) {
  if (!state().verbose) return;
  static std::mutex mutex;
  static auto* const said = new std::set<std::string>;
  const Lock lock(mutex);
  if (said->size() < 1000 && said->insert(line).second) say(line);
}

}  // namespace partita::layer
