#include "devices/layer/program_binary.h"

#include <cstdint>
#include <cstring>

#include "devices/layer/container.h"

namespace partita::layer {
namespace {

struct Header {
  char magic[8];
  std::uint32_t version;
  std::uint32_t keeps_arg_info;
  std::uint64_t payload_bytes;
  std::uint64_t checksum;  ///< of the payload
  char device[64];
};
static_assert(sizeof(Header) == 96);

constexpr char kMagic[8] = {'P', 'A', 'R', 'T', 'B', 'I', 'N', '\x1a'};

}  // namespace

std::string wrap_binary(const WrappedBinary& binary) {
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.version = 1;
  header.keeps_arg_info = binary.keeps_arg_info ? 1 : 0;
  header.payload_bytes = binary.payload.size();
  header.checksum = fingerprint(binary.payload);
  std::memcpy(header.device, binary.device.data(),
              std::min(binary.device.size(), sizeof header.device - 1));
  std::string out(reinterpret_cast<const char*>(&header), sizeof header);
  out.append(reinterpret_cast<const char*>(binary.payload.data()), binary.payload.size());
  return out;
}

std::optional<WrappedBinary> unwrap_binary(std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof header) return {};
  std::memcpy(&header, bytes.data(), sizeof header);
  const auto payload = bytes.subspan(sizeof header);
  if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0 || header.version != 1 ||
      header.keeps_arg_info > 1 || header.payload_bytes != payload.size() ||
      header.checksum != fingerprint(payload)) {
    return {};
  }
  header.device[sizeof header.device - 1] = 0;
  return WrappedBinary{header.device, header.keeps_arg_info == 1, payload};
}

}  // namespace partita::layer
