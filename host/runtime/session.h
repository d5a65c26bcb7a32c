// Session: one device in use by one host thread: a context, the programs of a set of kernel specs,
// and an in-order queue. Tasks ask it for buffers and launch kernels through it (see kernel.h).
#ifndef PARTITA_HOST_RUNTIME_SESSION_H
#define PARTITA_HOST_RUNTIME_SESSION_H

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host/runtime/device.h"
#include "host/runtime/extension.h"
#include "host/runtime/kernel_spec.h"

namespace partita::runtime {

/// Which text runs: the device's own variant, or the CPU variant, proven equal and quicker where
/// the device is emulated. What is charged is always the own variant's Work.
enum class Execute { own, fast };
std::string_view to_string(Execute execute);

struct SessionOptions {
  Execute execute = Execute::own;
  /// Runs and charges this text instead of the device's own: for verifying a GPU's or an FPGA's
  /// variant on any device that takes source.
  std::optional<Variant> variant = {};
  /// Container (xclbin) with all kernels, for a device that does not accept source.
  std::string container = {};
  /// Folder for cached binaries; empty: the user's cache folder; "-": no cache.
  std::string cache_folder = {};
};

class Session {
 public:
  using Specs = std::vector<const KernelSpec*>;

  /// Builds (or restores) the programs of all `specs`. Throws Error with the kernel file, the
  /// device and the first line of the compiler's complaint.
  Session(const Device& device, Specs specs, SessionOptions options = {});

  const Device& device() const { return device_; }
  const Extension& extension() const { return extension_; }
  const cl::Context& context() const { return context_; }
  const cl::CommandQueue& queue() const { return queue_; }
  Variant charged() const { return charged_; }
  Variant executed() const { return executed_; }

  /// A kernel object of its own; use Kernel (kernel.h) rather than this.
  cl::Kernel make_kernel(const KernelSpec& spec) const;
  cl::Buffer make_buffer(std::size_t bytes, cl_mem_flags flags = CL_MEM_READ_WRITE) const;
  void write(const cl::Buffer& buffer, std::span<const std::byte> bytes) const;  ///< not blocking:
  ///< keep `bytes` alive until the queue is finished
  void read(const cl::Buffer& buffer, std::span<std::byte> bytes) const;  ///< blocking
  void finish() const;

  /// Saves the programs' binaries, launches' specialisations included. Call after a warm-up.
  void save_binaries() const;

 private:
  struct Entry {
    cl::Program program;
    std::string cache_path;  ///< empty: not cached
    bool restored = false;
  };
  const Entry& entry_for(const KernelSpec& spec) const;
  void load_from_source(const KernelSpec& spec);
  void load_container(const std::string& path);

  Device device_;
  Extension extension_;
  Specs specs_;
  SessionOptions options_;
  Variant charged_;
  Variant executed_;
  cl::Context context_;
  cl::CommandQueue queue_;
  std::map<std::string, Entry> programs_;  ///< by kernel file and options
};

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_SESSION_H
