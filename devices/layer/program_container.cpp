// Loading a container into the emulated FPGA.
#include "devices/layer/call.h"
#include "devices/layer/program.h"
#include "devices/layer/program_text.h"
#include "devices/model/area.h"

namespace partita::layer {
namespace {

/// Refuses with one line to the context's callback and, with PARTITA_VERBOSE, to stderr.
cl_int refuse(const Context& context, const std::string& line, cl_int error) {
  context.tell(line);
  say_once(line);
  return error;
}

/// The container, if this device can hold it: built for it, not larger than it, and the same as
/// the one that is in use.
cl_int check_container(const Context& context, Device& device, std::span<const std::byte> bytes,
                       std::shared_ptr<LoadedContainer>& loaded) {
  if (!device.is_fpga()) {
    return refuse(context, device.machine.name + ": takes no container", CL_INVALID_BINARY);
  }
  const std::uint64_t print = fingerprint(bytes);
  {
    const Lock lock(state().mutex);
    loaded = device.container.lock();
  }
  if (loaded && loaded->fingerprint == print) return CL_SUCCESS;
  auto fresh = std::make_shared<LoadedContainer>();
  fresh->fingerprint = print;
  try {
    fresh->container = parse(bytes);
  } catch (const ContainerError& error) {
    return refuse(context, error.what(), CL_INVALID_BINARY);
  }
  const Container& container = fresh->container;
  if (container.device != device.profile.id) {
    return refuse(context,
                  "container: device: built for '" + container.device + "', expected '" +
                      device.profile.id + "'",
                  CL_INVALID_BINARY);
  }
  const std::string misfit = model::misfit(container.area, device.profile);
  if (!misfit.empty()) {
    return refuse(context, "container: area: " + misfit, CL_INVALID_BINARY);
  }
  if (loaded) {
    return refuse(context,
                  device.machine.name +
                      ": another container is in use; release all of its programs and kernels",
                  CL_OUT_OF_RESOURCES);
  }
  loaded = std::move(fresh);
  return CL_SUCCESS;
}

/// Writing the configuration takes the whole device; the calling thread waits for it. A container
/// that is in the device already is not written again.
void charge_loading(Device& device, const std::shared_ptr<LoadedContainer>& loaded) {
  State& s = state();
  const Lock lock(s.mutex);
  device.container = loaded;
  if (device.loaded == loaded->fingerprint) return;
  device.loaded = loaded->fingerprint;
  const timeline::ThreadId thread = current_thread();
  const timeline::QueueId queue = s.timeline->add_queue(device.index, false);
  timeline::Command command;
  command.queue = queue;
  command.kind = timeline::CommandKind::load;
  command.name = s.timeline->intern("load container");
  command.demand.launch_ns = device.profile.fabric.full_load_ns;
  const timeline::NodeId node = s.timeline->enqueue(thread, command);
  s.timeline->wait(thread, {&node, 1});
  s.timeline->release(node);
  s.timeline->remove_queue(queue);
}

std::string build_log(cl_program program, const Device& device) {
  std::size_t bytes = 0;
  target().clGetProgramBuildInfo(program, device.handle, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes);
  std::string log(bytes, '\0');
  target().clGetProgramBuildInfo(program, device.handle, CL_PROGRAM_BUILD_LOG, bytes, log.data(),
                                 nullptr);
  return log.c_str();
}

}  // namespace

cl_program load_container(cl_context handle, std::shared_ptr<Context> context,
                          std::span<const std::byte> bytes, cl_int& error) {
  Device& device = *context->devices[0];
  std::shared_ptr<LoadedContainer> loaded;
  error =
      device.fault.lost() ? CL_OUT_OF_RESOURCES : check_container(*context, device, bytes, loaded);
  if (error != CL_SUCCESS) return nullptr;
  if (device.fault.build_fails()) {
    error =
        refuse(*context, device.machine.name + ": injected fault: load fails", CL_INVALID_BINARY);
    return nullptr;
  }
  const Container& container = loaded->container;
  const cl_program program = create_driver_program(handle, context->devices, container.text, error);
  if (!program) return nullptr;
  const BuildOptions options = build_options(container.build_options.c_str(), context->devices);
  if (target().clBuildProgram(program, 0, nullptr, options.text.c_str(), nullptr, nullptr) !=
      CL_SUCCESS) {
    error = refuse(*context, "container: its text does not compile: " + build_log(program, device),
                   CL_INVALID_BINARY);
    target().clReleaseProgram(program);
    return nullptr;
  }
  charge_loading(device, loaded);
  auto entry = make_program(std::move(context));
  entry->container = std::move(loaded);
  entry->container_bytes.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  entry->keeps_arg_info = true;
  register_program(program, std::move(entry));
  return program;
}

}  // namespace partita::layer
