#include "devices/profile/profile.h"

#include <filesystem>

#include "devices/profile/reader.h"
#include "devices/profile/schema.h"

namespace partita::profile {

std::string_view to_string(DeviceType type) {
  switch (type) {
    case DeviceType::cpu:
      return "cpu";
    case DeviceType::gpu:
      return "gpu";
    case DeviceType::fpga:
      return "fpga";
  }
  return "?";
}

cl_device_type cl_type(DeviceType type) {
  switch (type) {
    case DeviceType::cpu:
      return CL_DEVICE_TYPE_CPU;
    case DeviceType::gpu:
      return CL_DEVICE_TYPE_GPU;
    case DeviceType::fpga:
      return CL_DEVICE_TYPE_ACCELERATOR;
  }
  return CL_DEVICE_TYPE_DEFAULT;
}

std::string hash_bytes(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (int i = 15; i >= 0; --i, hash >>= 4) text[static_cast<std::size_t>(i)] = kDigits[hash & 15];
  return text;
}

DeviceProfile parse_device(const std::string& text, const std::string& path) try {
  DeviceProfile device;
  device.path = path;
  device.id = std::filesystem::path(path).stem().string();
  device.content_hash = hash_bytes(text);
  const Reader reader = Reader::parse(text, path, &device.numbers);
  std::vector<std::string_view> keys{"name",        "vendor", "type",  "price", "opencl",
                                     "performance", "host",   "power", "link",  "uncertainty"};
  reader.allow({"name", "vendor", "type", "price", "opencl", "performance", "host", "power", "link",
                "fabric", "uncertainty"});
  device.name = reader.text("name");
  device.vendor = reader.text("vendor");
  device.type = static_cast<DeviceType>(reader.choice("type", {"cpu", "gpu", "fpga"}));
  if (device.type == DeviceType::fpga) keys.push_back("fabric");
  reader.allow(keys);
  device.price_usd = reader.number("price", {"USD", 0, 1e7});
  device.uncertainty = read_uncertainty(reader);
  read_opencl(reader.section("opencl"), device.opencl);
  read_performance(reader.section("performance"), device.type, device.performance);
  read_host(reader.section("host"), device.host);
  read_power(reader.section("power"), device.power);
  read_link(reader.section("link"), device.link);
  if (device.type == DeviceType::fpga) read_fabric(reader.section("fabric"), device.fabric);
  return device;
} catch (const YAML::Exception& e) {  // a node of a shape that the reader did not foresee
  throw Error(path + ":" + std::to_string(std::max(e.mark.line, 0) + 1) + ": " + e.msg);
}

DeviceProfile load_device(const std::string& path) {
  return parse_device(read_file(path), path);
}

}  // namespace partita::profile
