// What the layer remembers about each of the program's OpenCL objects.
#ifndef PARTITA_DEVICES_LAYER_OBJECTS_H
#define PARTITA_DEVICES_LAYER_OBJECTS_H

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CL/cl.h>

#include "devices/layer/container.h"
#include "devices/model/model.h"
#include "devices/timeline/command.h"
#include "devices/work.h"

namespace partita::layer {

struct Device;
struct Platform;

struct Context {
  std::vector<Device*> devices;
  std::vector<cl_context_properties> properties;  ///< as given, with the final 0; may be empty
  void(CL_CALLBACK* notify)(const char*, const void*, std::size_t, void*) = nullptr;
  void* user_data = nullptr;

  /// Tells the program through its callback, if it gave one.
  void tell(const std::string& line) const {
    if (notify) notify(line.c_str(), nullptr, 0, user_data);
  }
};

struct Queue {
  std::shared_ptr<Context> context;
  Device* device = nullptr;
  timeline::QueueId id = timeline::kNone;
  cl_command_queue_properties properties = 0;
  std::vector<cl_queue_properties> list;  ///< as given, with the final 0; may be empty

  bool profiling() const { return (properties & CL_QUEUE_PROFILING_ENABLE) != 0; }
};

/// A container while any program made from it is alive; the FPGA takes no other meanwhile.
struct LoadedContainer {
  Container container;
  std::uint64_t fingerprint = 0;
};

/// A build that the layer itself refused; the driver never saw it.
struct RefusedBuild {
  std::string log;
};

struct Program {
  std::shared_ptr<Context> context;
  std::vector<Device*> devices;
  std::string source;   ///< as given; empty: not made from source
  std::string options;  ///< of the last build, as given
  bool built = false;   ///< clBuildProgram was called: options are to be reported
  std::optional<RefusedBuild> refused;
  bool keeps_arg_info = false;  ///< built with -cl-kernel-arg-info by the program's own wish
  std::shared_ptr<LoadedContainer> container;
  std::string container_bytes;  ///< what CL_PROGRAM_BINARIES gives back
  std::string loaded;  ///< the driver's binary that it was made from, until a build makes another
  std::atomic<std::uint32_t> builds{0};  ///< estimates are of one build
  std::shared_ptr<const std::string>
      unlinked;                      ///< estimates read it: code without kernels' machine code
  std::uint32_t unlinked_build = 0;  ///< the build whose source and options that was

  bool from_container() const { return container != nullptr; }
};

/// What one work-item of a kernel with no declared Work does, from its compiled code (estimate.h).
struct ItemEstimate {
  Work per_item;
  std::uint64_t iterations = 1;  ///< of its innermost loops together: an FPGA's cycles
};

struct KernelArg {
  bool local = false, buffer = false;
  bool constant = false;          ///< a buffer or image that the kernel does not write
  std::uint64_t local_bytes = 0;  ///< of the last clSetKernelArg
  cl_mem memory = nullptr;        ///< the same; bounds an estimate's unique bytes
};

struct Kernel {
  std::shared_ptr<Program> program;
  std::string name;
  timeline::NameId name_id = 0;
  std::vector<KernelArg> args;
  std::array<std::size_t, 3> required{};  ///< reqd_work_group_size; zeros: none
  std::uint64_t static_local = 0;         ///< bytes of __local variables in the kernel
  std::size_t group_limit = 0;            ///< the driver's CL_KERNEL_WORK_GROUP_SIZE
  const ContainerKernel* circuit = nullptr;
  std::shared_ptr<const ItemEstimate> estimate;  ///< made at the first launch without Work

  std::uint64_t local_args() const {
    std::uint64_t sum = 0;
    for (const KernelArg& a : args) sum += a.local_bytes;
    return sum;
  }
};

struct Mapping {
  void* pointer = nullptr;
  std::uint64_t bytes = 0;
  bool writes = false;
};

struct Memory {
  ~Memory();  ///< gives `bytes` back to the devices

  std::shared_ptr<Context> context;
  std::shared_ptr<Memory> parent;  ///< of a sub-buffer or of an image made from a buffer
  std::uint64_t bytes = 0;
  std::uint64_t element_bytes = 1;  ///< images: of a pixel
  std::vector<Device*> charged;     ///< devices whose memory it takes
  Device* home = nullptr;           ///< has the contents alone; null: no device is ahead
  std::vector<Mapping> mappings;
};

struct Sampler {
  explicit Sampler(std::shared_ptr<Context> made_in) : context(std::move(made_in)) {}
  std::shared_ptr<Context> context;
};

/// An event of the program. A command without one is known to the timeline alone.
struct Event {
  timeline::NodeId node = timeline::kNone;
  std::uint32_t references = 1;
  bool user = false;
  bool profiling = false;
  bool status_set = false;   ///< user events: set once already
  cl_command_type type = 0;  ///< where the driver's differs; 0: it does not
};

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_OBJECTS_H
