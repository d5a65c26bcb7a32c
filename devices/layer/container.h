// Container: what an emulated FPGA loads instead of source, our stand-in for an xclbin. It carries
// the circuits' static figures (clock, area, loops) and, as their functional model, the OpenCL C
// text that runs on the CPU underneath. Plain C++ and no OpenCL call, so that `partita package`
// writes with the same code that the layer reads with.
//
// File layout, little-endian:
//   0   8 bytes  magic "PARTITA\x1a"
//   8   u32      version (1)
//   12  u32      flags (0)
//   16  u64      bytes of the header (JSON, UTF-8)
//   24  u64      bytes of the text (OpenCL C)
//   32  u64      FNV-1a 64 of everything after this field
//   40  header, then text; nothing after it
#ifndef PARTITA_DEVICES_LAYER_CONTAINER_H
#define PARTITA_DEVICES_LAYER_CONTAINER_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "devices/profile/profile.h"
#include "devices/work.h"

namespace partita::layer {

/// One line: what is wrong with the container and at which byte or key.
class ContainerError : public std::runtime_error {
 public:
  explicit ContainerError(const std::string& message) : std::runtime_error(message) {}
};

struct ContainerArg {
  std::string name;
  std::string type;           ///< as in the source: "uint*"
  std::string address_space;  ///< global, constant, local or private
  bool operator==(const ContainerArg&) const = default;
};

/// A pipelined loop as the circuit has it; how often it turns is known only at launch.
struct ContainerLoop {
  std::string name;
  std::uint32_t ii = 1;
  std::uint32_t depth = 0;
  bool operator==(const ContainerLoop&) const = default;
};

struct ContainerKernel {
  std::string name;
  std::vector<ContainerArg> args;
  std::vector<ContainerLoop> loops;
  std::array<std::uint64_t, 3> work_group{1, 1, 1};  ///< reqd_work_group_size
  FpgaDesign design;   ///< what is instantiated, all compute units included
  profile::Area area;  ///< of this kernel, all compute units included
};

struct Container {
  std::string device;  ///< id of the device profile it is built for: "zcu102"
  double clock_mhz = 0;
  std::vector<ContainerKernel> kernels;  ///< names are distinct
  profile::Area area;         ///< of the whole design, shell included: what must fit the device
  std::string build_options;  ///< for compiling `text`
  std::string text;           ///< OpenCL C, flattened: no #include of files

  const ContainerKernel* find(const std::string& kernel) const;
};

/// Bytes that begin like a container, whole or not.
bool is_container(std::span<const std::byte> bytes);

/// The file's bytes; the same container gives the same bytes.
std::string serialize(const Container& container);

/// Reads strictly: truncated or trailing bytes, a wrong checksum, unknown or missing keys, a wrong
/// type, a clock outside (0, 2000] MHz, no kernel or two of one name throw ContainerError.
Container parse(std::span<const std::byte> bytes);
Container parse(const std::string& bytes);

/// Identity of a container: two of the same bytes are one configuration of the device.
std::uint64_t fingerprint(std::span<const std::byte> bytes);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_CONTAINER_H
