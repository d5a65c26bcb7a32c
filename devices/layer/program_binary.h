// Program binaries: the driver's own, marked with the emulated device that they are for, so that
// a binary of one emulated device is refused by another.
#ifndef PARTITA_DEVICES_LAYER_PROGRAM_BINARY_H
#define PARTITA_DEVICES_LAYER_PROGRAM_BINARY_H

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace partita::layer {

/// What a wrapped binary holds. `device` is the profile's id.
struct WrappedBinary {
  std::string device;
  bool keeps_arg_info = false;
  std::span<const std::byte> payload;
};

std::string wrap_binary(const WrappedBinary& binary);

/// Empty if the bytes are not a whole wrapped binary with the right checksum. The payload points
/// into `bytes`.
std::optional<WrappedBinary> unwrap_binary(std::span<const std::byte> bytes);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_PROGRAM_BINARY_H
