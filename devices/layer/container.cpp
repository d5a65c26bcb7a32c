#include "devices/layer/container.h"

#include <bit>
#include <cstring>
#include <set>

#include <nlohmann/json.hpp>

namespace partita::layer {
namespace {

using nlohmann::json;

constexpr char kMagic[8] = {'P', 'A', 'R', 'T', 'I', 'T', 'A', '\x1a'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kPrefixBytes = 40;
static_assert(std::endian::native == std::endian::little, "the format is little-endian");

std::uint64_t fnv1a(const void* data, std::size_t bytes) {
  const auto* p = static_cast<const unsigned char*>(data);
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (std::size_t i = 0; i < bytes; ++i) hash = (hash ^ p[i]) * 0x100000001b3ull;
  return hash;
}

template <typename T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
T take(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

json area_json(const profile::Area& a) {
  return {{"lut", a.lut}, {"ff", a.ff}, {"bram36", a.bram36}, {"uram", a.uram}, {"dsp", a.dsp}};
}

json design_json(const FpgaDesign& d) {
  json buffers = json::array();
  for (std::uint32_t i = 0; i < d.buffer_count; ++i) {
    const OnChipBuffer& b = d.buffers[i];
    buffers.push_back(
        {{"depth", b.depth}, {"width_bits", b.width_bits}, {"banks", b.banks}, {"ports", b.ports}});
  }
  return {{"buffers", buffers},
          {"operators", d.operators},
          {"operand_bits", d.operand_bits},
          {"memory_ports", d.memory_ports},
          {"compute_units", d.compute_units}};
}

json kernel_json(const ContainerKernel& k) {
  json args = json::array(), loops = json::array();
  for (const ContainerArg& a : k.args) {
    args.push_back({{"name", a.name}, {"type", a.type}, {"address_space", a.address_space}});
  }
  for (const ContainerLoop& l : k.loops) {
    loops.push_back({{"name", l.name}, {"ii", l.ii}, {"depth", l.depth}});
  }
  return {{"name", k.name},
          {"args", args},
          {"loops", loops},
          {"work_group", k.work_group},
          {"design", design_json(k.design)},
          {"area", area_json(k.area)}};
}

/// Walks one JSON object: every key that it holds must be asked for, every key asked for be there.
class Reader {
 public:
  Reader(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object_.is_object()) fail(where_, "expected an object");
  }

  const json& at(const char* key) {
    const auto it = object_.find(key);
    if (it == object_.end()) fail(where_ + key, "missing");
    seen_.insert(key);
    return *it;
  }
  std::string path(const char* key) const { return where_ + key; }

  std::string text(const char* key) {
    const json& value = at(key);
    if (!value.is_string()) fail(path(key), "expected a string");
    return value.get<std::string>();
  }
  double number(const char* key) {
    const json& value = at(key);
    if (!value.is_number()) fail(path(key), "expected a number");
    return value.get<double>();
  }
  std::uint64_t count(const char* key, std::uint64_t max) {
    return to_count(at(key), path(key), max);
  }
  const json& list(const char* key, std::size_t max) {
    const json& value = at(key);
    if (!value.is_array() || value.size() > max) {
      fail(path(key), "expected a list of at most " + std::to_string(max));
    }
    return value;
  }
  void done() const {
    for (const auto& [key, value] : object_.items()) {
      if (!seen_.count(key)) fail(where_ + key, "unknown key");
    }
  }

  static std::uint64_t to_count(const json& value, const std::string& where, std::uint64_t max) {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max) {
      fail(where, "expected a whole number up to " + std::to_string(max));
    }
    return value.get<std::uint64_t>();
  }
  [[noreturn]] static void fail(const std::string& where, const std::string& what) {
    throw ContainerError("container: header: " + where + ": " + what);
  }

 private:
  const json& object_;
  std::string where_;
  std::set<std::string> seen_;
};

constexpr std::uint64_t kMax32 = 0xffffffffull;
constexpr std::uint64_t kMaxCount = 1ull << 53;

std::string indexed(const std::string& where, std::size_t i) {
  return where + "[" + std::to_string(i) + "].";
}

profile::Area read_area(const json& value, const std::string& where) {
  Reader in(value, where + ".");
  profile::Area a;
  a.lut = in.count("lut", kMaxCount);
  a.ff = in.count("ff", kMaxCount);
  a.bram36 = in.count("bram36", kMaxCount);
  a.uram = in.count("uram", kMaxCount);
  a.dsp = in.count("dsp", kMaxCount);
  in.done();
  return a;
}

FpgaDesign read_design(const json& value, const std::string& where) {
  Reader in(value, where + ".");
  FpgaDesign d;
  const json& buffers = in.list("buffers", kMaxBuffers);
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    Reader b(buffers[i], indexed(in.path("buffers"), i));
    OnChipBuffer& buffer = d.buffers[d.buffer_count++];
    buffer.depth = b.count("depth", kMaxCount);
    buffer.width_bits = static_cast<std::uint32_t>(b.count("width_bits", kMax32));
    buffer.banks = static_cast<std::uint32_t>(b.count("banks", kMax32));
    buffer.ports = static_cast<std::uint32_t>(b.count("ports", kMax32));
    b.done();
  }
  const json& operators = in.list("operators", kOpClasses);
  if (operators.size() != kOpClasses) {
    Reader::fail(in.path("operators"), "expected " + std::to_string(kOpClasses) + " numbers");
  }
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    d.operators[i] =
        static_cast<std::uint32_t>(Reader::to_count(operators[i], in.path("operators"), kMax32));
  }
  d.operand_bits = static_cast<std::uint32_t>(in.count("operand_bits", kMax32));
  d.memory_ports = static_cast<std::uint32_t>(in.count("memory_ports", kMax32));
  d.compute_units = static_cast<std::uint32_t>(in.count("compute_units", kMax32));
  in.done();
  return d;
}

void read_args(Reader& in, ContainerKernel& k) {
  const json& args = in.list("args", 1024);
  for (std::size_t i = 0; i < args.size(); ++i) {
    Reader a(args[i], indexed(in.path("args"), i));
    k.args.push_back({a.text("name"), a.text("type"), a.text("address_space")});
    a.done();
  }
}

void read_loops(Reader& in, ContainerKernel& k) {
  const json& loops = in.list("loops", 1024);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    Reader l(loops[i], indexed(in.path("loops"), i));
    ContainerLoop loop;
    loop.name = l.text("name");
    loop.ii = static_cast<std::uint32_t>(l.count("ii", kMax32));
    loop.depth = static_cast<std::uint32_t>(l.count("depth", kMax32));
    l.done();
    k.loops.push_back(loop);
  }
}

ContainerKernel read_kernel(const json& value, const std::string& where) {
  Reader in(value, where);
  ContainerKernel k;
  k.name = in.text("name");
  if (k.name.empty()) Reader::fail(in.path("name"), "expected a kernel's name");
  read_args(in, k);
  read_loops(in, k);
  const json& group = in.list("work_group", 3);
  if (group.size() != 3) Reader::fail(in.path("work_group"), "expected 3 numbers");
  for (std::size_t i = 0; i < 3; ++i) {
    k.work_group[i] = Reader::to_count(group[i], in.path("work_group"), kMax32);
    if (k.work_group[i] == 0) Reader::fail(in.path("work_group"), "expected numbers above 0");
  }
  k.design = read_design(in.at("design"), in.path("design"));
  k.area = read_area(in.at("area"), in.path("area"));
  in.done();
  return k;
}

Container read_header(const json& header) {
  Reader in(header, "");
  Container c;
  c.device = in.text("device");
  c.clock_mhz = in.number("clock_mhz");
  if (!(c.clock_mhz > 0 && c.clock_mhz <= 2000)) {
    Reader::fail("clock_mhz", "expected a clock in (0, 2000]");
  }
  const json& kernels = in.list("kernels", 1024);
  if (kernels.empty()) Reader::fail("kernels", "expected at least one kernel");
  for (std::size_t i = 0; i < kernels.size(); ++i) {
    c.kernels.push_back(read_kernel(kernels[i], indexed("kernels", i)));
    for (std::size_t j = 0; j < i; ++j) {
      if (c.kernels[j].name == c.kernels[i].name) {
        Reader::fail("kernels", "two kernels named '" + c.kernels[i].name + "'");
      }
    }
  }
  c.area = read_area(in.at("area"), "area");
  c.build_options = in.text("build_options");
  in.done();
  return c;
}

}  // namespace

const ContainerKernel* Container::find(const std::string& kernel) const {
  for (const ContainerKernel& k : kernels) {
    if (k.name == kernel) return &k;
  }
  return nullptr;
}

bool is_container(std::span<const std::byte> bytes) {
  return bytes.size() >= sizeof kMagic && std::memcmp(bytes.data(), kMagic, sizeof kMagic) == 0;
}

std::string serialize(const Container& c) {
  json kernels = json::array();
  for (const ContainerKernel& k : c.kernels) kernels.push_back(kernel_json(k));
  const std::string header = json{
      {"device", c.device},
      {"clock_mhz", c.clock_mhz},
      {"kernels", kernels},
      {"area", area_json(c.area)},
      {"build_options",
       c.build_options}}.dump();
  const std::string body = header + c.text;
  std::string out(kMagic, sizeof kMagic);
  put(out, kVersion);
  put(out, std::uint32_t{0});
  put(out, std::uint64_t{header.size()});
  put(out, std::uint64_t{c.text.size()});
  put(out, fnv1a(body.data(), body.size()));
  return out + body;
}

Container parse(std::span<const std::byte> bytes) {
  if (!is_container(bytes)) throw ContainerError("container: byte 0: not a Partita container");
  if (bytes.size() < kPrefixBytes) throw ContainerError("container: truncated in its first bytes");
  const auto version = take<std::uint32_t>(bytes, 8);
  if (version != kVersion || take<std::uint32_t>(bytes, 12) != 0) {
    throw ContainerError("container: byte 8: version " + std::to_string(version) +
                         ", expected version 1 and no flags");
  }
  const auto header_bytes = take<std::uint64_t>(bytes, 16);
  const auto text_bytes = take<std::uint64_t>(bytes, 24);
  const std::uint64_t body = bytes.size() - kPrefixBytes;
  if (header_bytes > body || text_bytes != body - header_bytes) {
    throw ContainerError("container: byte 16: " + std::to_string(bytes.size()) +
                         " bytes, which is not what its first bytes announce");
  }
  const auto* data = reinterpret_cast<const char*>(bytes.data());
  if (fnv1a(data + kPrefixBytes, body) != take<std::uint64_t>(bytes, 32)) {
    throw ContainerError("container: byte 32: checksum does not match the contents");
  }
  const char* header = data + kPrefixBytes;
  const json parsed = json::parse(header, header + header_bytes, nullptr, false);
  if (parsed.is_discarded()) throw ContainerError("container: header: not JSON");
  Container c = read_header(parsed);
  c.text.assign(header + header_bytes, text_bytes);
  return c;
}

Container parse(const std::string& bytes) {
  return parse(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

std::uint64_t fingerprint(std::span<const std::byte> bytes) {
  return fnv1a(bytes.data(), bytes.size());
}

}  // namespace partita::layer
