// Profiles: the shipped ones load and say where every number is from; bad ones are refused in one
// line that names file, line and key.
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/profile/machine.h"

namespace partita::profile {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

const std::string kProfiles = PARTITA_SOURCE_DIR "/profiles";

std::string file_text(const std::string& name) {
  std::ifstream in(kProfiles + "/devices/" + name + ".yaml");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The text with its first `from` replaced; fails the test if there is none.
std::string edited(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    parse_device(text, "some/file.yaml");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Profiles, EveryShippedDeviceLoadsAndEveryNumberHasASource) {
  const auto names = list_devices(kProfiles);
  EXPECT_THAT(names, ::testing::IsSupersetOf({"cortex-a53", "cortex-a53-k26", "gtx1060", "h200",
                                              "i5-8500", "kv260", "orin-nano-cpu", "orin-nano-gpu",
                                              "rtx4060", "ryzen-9700x", "tx2-cpu", "tx2-gpu",
                                              "u250", "xeon-8568y", "zcu102"}));
  for (const auto& name : names) {
    const DeviceProfile device = load_device(kProfiles + "/devices/" + name + ".yaml");
    EXPECT_EQ(device.id, name);
    EXPECT_GT(device.numbers.size(), 70u) << name;
    for (const Provenance& number : device.numbers) {
      EXPECT_GE(number.source.size(), 10u) << name << ": " << number.key;
      EXPECT_GE(number.date.size(), 4u) << name << ": " << number.key;
      EXPECT_GT(number.line, 0);
    }
    EXPECT_EQ(device.content_hash, hash_bytes(file_text(name)));
  }
}

TEST(Profiles, EveryShippedMachineLoads) {
  for (const auto& name : list_machines(kProfiles)) {
    const Machine machine = load_machine(name, kProfiles);
    EXPECT_EQ(load_machine(machine.path).content_hash, machine.content_hash);
  }
  const Machine dragonfly = load_machine("dragonfly", kProfiles);
  ASSERT_EQ(dragonfly.devices.size(), 3u);
  EXPECT_EQ(dragonfly.devices[0].profile.type, DeviceType::fpga);
  EXPECT_EQ(dragonfly.devices[1].profile.type, DeviceType::gpu);
  EXPECT_TRUE(dragonfly.devices[2].is_host_cpu);
  EXPECT_EQ(dragonfly.nodes[dragonfly.sensor_node].name, "zynq");
  EXPECT_EQ(dragonfly.nodes[dragonfly.main_node].name, "pc");
  EXPECT_EQ(dragonfly.links.size(), 1u);
}

TEST(Profiles, DevicesAnswerAsTheirRuntimesDo) {
  const auto gpu = load_device(kProfiles + "/devices/gtx1060.yaml").opencl;
  EXPECT_EQ(gpu.platform_name, "NVIDIA CUDA");
  EXPECT_EQ(gpu.max_work_group_size, 1024u);
  EXPECT_EQ(gpu.local_mem_size, 49152u);
  EXPECT_TRUE(gpu.doubles());
  EXPECT_TRUE(gpu.image_support);
  EXPECT_EQ(gpu.max_mem_alloc_size, gpu.global_mem_size / 4);
  const auto fpga = load_device(kProfiles + "/devices/zcu102.yaml").opencl;
  EXPECT_EQ(fpga.platform_name, "Xilinx");
  EXPECT_EQ(fpga.device_profile, "EMBEDDED_PROFILE");
  EXPECT_EQ(fpga.device_version, "OpenCL 1.0");
  EXPECT_EQ(fpga.max_work_group_size, 4294967295u);
  EXPECT_EQ(fpga.local_mem_size, 16384u);
  EXPECT_EQ(fpga.max_mem_alloc_size, 128u << 20);
  EXPECT_FALSE(fpga.doubles());
  EXPECT_FALSE(fpga.image_support);
  EXPECT_FALSE(fpga.compiler_available);
  const auto card = load_device(kProfiles + "/devices/u250.yaml");
  EXPECT_EQ(card.opencl.max_mem_alloc_size, 4ull << 30);
  EXPECT_FALSE(card.link.shared_memory);
}

/// A machine's devices, each once: nodes' host CPUs, and what is not one.
std::vector<const DeviceProfile*> parts(const Machine& machine) {
  std::vector<const DeviceProfile*> parts;
  for (const Node& node : machine.nodes) parts.push_back(&node.host);
  for (const MachineDevice& device : machine.devices) {
    if (!device.is_host_cpu) parts.push_back(&device.profile);
  }
  return parts;
}

/// Power of a part at full load with its memory at full bandwidth.
double full_load_w(const DeviceProfile& part) {
  const Performance& p = part.performance;
  return part.power.busy_w +
         p.memory_bandwidth * p.memory_reachable * part.power.transfer_j_per_byte;
}

TEST(Profiles, WhatSharesABoardIsPaidOnce) {
  const std::map<std::string, double> prices{
      {"cpu-only", 192},        {"gpu-only", 192 + 249},         {"tx2", 399},
      {"orin-nano", 249},       {"dragonfly", 2495 + 192 + 249}, {"kv260-rtx", 249 + 359 + 299},
      {"h200", 6497 + 35000.0}, {"u250-rtx", 12995 + 359 + 299},
  };
  for (const auto& [name, price] : prices) {
    double sum = 0;
    const Machine machine = load_machine(name, kProfiles);
    for (const DeviceProfile* part : parts(machine)) sum += part->price_usd;
    EXPECT_DOUBLE_EQ(sum, price) << name;
  }
}

TEST(Profiles, FullLoadIsWhatBoardsAndModulesDraw) {
  const std::map<std::string, double> boards{
      {"gtx1060", 120}, {"rtx4060", 115}, {"h200", 700}, {"u250", 110}};
  for (const auto& [name, watts] : boards) {
    EXPECT_NEAR(full_load_w(load_device(kProfiles + "/devices/" + name + ".yaml")), watts,
                0.02 * watts)
        << name;
  }
  // Devices of a module share its memory, whose traffic therefore counts once.
  for (const auto& [name, watts] : std::map<std::string, double>{{"tx2", 18}, {"orin-nano", 25}}) {
    const Machine machine = load_machine(name, kProfiles);
    const double gpu = machine.devices[0].profile.power.busy_w;
    EXPECT_NEAR(full_load_w(machine.nodes[0].host) + gpu, watts, 0.05 * watts) << name;
  }
}

TEST(Profiles, PeaksFollowFromClockUnitsAndRate) {
  const std::map<std::string, double> tera{{"gtx1060", 4.37},       {"tx2-gpu", 0.666},
                                           {"orin-nano-gpu", 2.09}, {"rtx4060", 15.1},
                                           {"h200", 66.9},          {"i5-8500", 0.749}};
  for (const auto& [name, flops] : tera) {
    const Performance p = load_device(kProfiles + "/devices/" + name + ".yaml").performance;
    const double fma = p.ops_per_cycle[static_cast<std::size_t>(OpClass::float_fma)];
    EXPECT_NEAR(2 * fma * p.units * p.clock_hz / 1e12, flops, 0.005 * flops) << name;
  }
}

TEST(Profiles, NoCopyIsFasterThanItsMemory) {
  for (const auto& name : list_devices(kProfiles)) {
    const Performance p = load_device(kProfiles + "/devices/" + name + ".yaml").performance;
    EXPECT_LE(2 * p.copy_bandwidth, p.memory_bandwidth * p.memory_reachable) << name;
  }
}

struct BadInput {
  const char* from;
  const char* to;
  const char* expected;  ///< parts of the message, separated by '|'
};

void PrintTo(const BadInput& bad, std::ostream* out) {
  *out << bad.to;
}

struct BadProfile : ::testing::TestWithParam<BadInput> {};

TEST_P(BadProfile, IsOneLineThatNamesFileLineAndKey) {
  const std::string good = file_text("gtx1060");
  const std::string error = error_of(edited(good, GetParam().from, GetParam().to));
  ASSERT_NE(error, "");
  EXPECT_THAT(error, ::testing::MatchesRegex("some/file.yaml:[0-9]+: .*"));
  EXPECT_THAT(error, Not(HasSubstr("\n")));
  std::stringstream parts(GetParam().expected);
  for (std::string part; std::getline(parts, part, '|');) EXPECT_THAT(error, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadProfile,
    ::testing::Values(
        BadInput{"  memory_bandwidth:", "  memory_bandwith:",
                 "memory_bandwith|unknown key|memory_bandwidth"},
        BadInput{"value: 192.2e9", "value: -192.2e9",
                 "performance.memory_bandwidth|-1.922e+11|B/s in [1000000,"},
        BadInput{"value: 192.2e9", "value: 0", "performance.memory_bandwidth: 0|expected"},
        BadInput{"value: 192.2e9", "value: 1e300", "performance.memory_bandwidth|expected"},
        BadInput{"value: 192.2e9", "value: nan", "memory_bandwidth|'nan'|expected"},
        BadInput{"value: 192.2e9", "value: 192.2 GB", "memory_bandwidth|'192.2 GB'"},
        BadInput{"value: 192.2e9", "value: \"192\"", "memory_bandwidth|'192'|a number"},
        BadInput{"{value: 192.2e9, unit: B/s", "{value: 192.2e9, unit: GB/s",
                 "unit is 'GB/s'|'B/s'"},
        BadInput{"{value: 192.2e9, unit: B/s", "{value: 192.2e9", "memory_bandwidth|unit is ''"},
        BadInput{"{value: 192.2e9, unit: B/s", "{valu: 192.2e9, unit: B/s", "valu|value"},
        BadInput{"unit: B/s, source: \"NVIDIA specification: 8 Gb/s GDDR5, 192 bit\"", "unit: B/s",
                 "memory_bandwidth|no source"},
        BadInput{"  units: {value: 10,", "  units: {value: 10.5,",
                 "performance.units: 10.5|whole number"},
        BadInput{"type: gpu", "type: npu", "type|'npu'|cpu, gpu, fpga"},
        BadInput{"name: GeForce GTX 1060 6GB", "name: [a]", "name|a list|a text"},
        BadInput{"vendor: NVIDIA Corporation", "", "vendor|missing"},
        BadInput{"  local_mem_dedicated: true", "  local_mem_dedicated: yes",
                 "local_mem_dedicated|'yes'|true or false"},
        BadInput{"[1024, 1024, 64]", "[1024, 1024]", "max_work_item_sizes|a list of 3"},
        BadInput{"[1024, 1024, 64]", "[1024, 0, 64]", "max_work_item_sizes|0, expected"},
        BadInput{"[denorm,", "[denorn,", "single_fp_config|'denorn'"},
        BadInput{"max_mem_alloc_size: 1593294848", "max_mem_alloc_size: 9593294848",
                 "max_mem_alloc_size|global_mem_size"},
        BadInput{"    stream: 0.7\n", "    stream: 1.7\n", "compute_efficiency.stream|[0.001, 1]"},
        BadInput{"    stencil: 0.7\n", "    stencil: 0.9\n",
                 "memory_efficiency.stencil|memory_reachable"},
        BadInput{"power:", "power: 3\nother:", "other|unknown"},
        BadInput{"  idle: {value: 6,", "  idle: {value: 200,", "power.busy|idle"},
        BadInput{"link:", "link: {}\nlink2:", "link2|unknown"},
        BadInput{"opencl:", "opencl: text\nvendor:", "vendor|twice"},
        BadInput{"  address_bits: 64", "  address_bits: 64\n  address_bits: 64",
                 "address_bits|twice"},
        BadInput{"date: 2026-11", "date: soon", "date|'soon'|YYYY"},
        BadInput{"performance:", "performance: [", "not valid YAML"},
        BadInput{"  occupancy:", "  port_bytes: 3\n  occupancy:", "port_bytes|unknown key"}),
    [](const auto& test) { return "Case" + std::to_string(test.index); });

TEST(Profiles, ANumberWithoutADateIsRefused) {
  const std::string undated = edited(file_text("gtx1060"), "date: 2026-11\n", "");
  EXPECT_THAT(error_of(undated), HasSubstr("no date"));
}

TEST(Profiles, TheLineIsTheKeysOwn) {
  const std::string text = file_text("zcu102");
  const auto at = text.find("  memory_reachable:");
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
  const std::string bad =
      edited(text, "memory_reachable: {value: 0.75", "memory_reachable: {value: 7.5");
  EXPECT_THAT(error_of(bad), HasSubstr("some/file.yaml:" + std::to_string(line) + ": "));
}

TEST(Profiles, UncertaintyIsOptionalAndHasASource) {
  const auto with = [](const std::string& line) {
    const std::string text = file_text("gtx1060");
    // Whatever the shipped profile says of it.
    const auto old = text.find("\nuncertainty:");
    const std::string rest = old == std::string::npos
                                 ? text
                                 : text.substr(0, old) + text.substr(text.find('\n', old + 1));
    return edited(rest, "\npower:", "\n" + line + "\npower:");
  };
  const DeviceProfile none = parse_device(with(""), "some/file.yaml");
  EXPECT_FALSE(none.uncertainty.has_value());
  EXPECT_EQ(uncertainty(none), kDefaultUncertainty);
  const DeviceProfile stated = parse_device(
      with("uncertainty: {value: 0.1, source: \"measured on one card\"}"), "some/file.yaml");
  EXPECT_EQ(uncertainty(stated), 0.1);
  EXPECT_EQ(stated.numbers.size(), none.numbers.size() + 1);
  EXPECT_THAT(error_of(with("uncertainty: {value: 1.5, source: \"none at all\"}")),
              HasSubstr("uncertainty: 1.5, expected"));
  EXPECT_THAT(error_of(with("uncertainty: 0.1")), HasSubstr("no source"));
}

struct MachineFiles : ::testing::Test {
  void SetUp() override {
    folder = fs::path(::testing::TempDir()) / "partita_machines";
    fs::create_directories(folder / "machines");
    fs::remove_all(folder / "devices");
    fs::copy(kProfiles + "/devices", folder / "devices");
  }
  void TearDown() override { fs::remove_all(folder); }
  std::string error(const std::string& from, const std::string& to) {
    std::ifstream in(kProfiles + "/machines/dragonfly.yaml");
    std::stringstream text;
    text << in.rdbuf();
    std::ofstream(folder / "machines" / "m.yaml") << edited(text.str(), from, to);
    try {
      load_machine("m", folder.string());
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
      return e.what();
    }
    return "";
  }
  fs::path folder;
};

TEST_F(MachineFiles, BadMachinesAreRefused) {
  EXPECT_EQ(error("description", "description"), "");
  EXPECT_THAT(error("host: i5-8500", "host: i9"),
              HasSubstr("no device profile 'i9', expected one of"));
  EXPECT_THAT(error("host: i5-8500", "host: gtx1060"), HasSubstr("not a cpu"));
  EXPECT_THAT(error("[zcu102]", "[zcu102, zcu102]"), HasSubstr("twice"));
  EXPECT_THAT(error("[zcu102]", "[i5-8500]"), HasSubstr("beside the host"));
  EXPECT_THAT(error("from: zynq", "from: nowhere"), HasSubstr("links.ethernet.from: is 'nowhere'"));
  EXPECT_THAT(error("to: pc", "to: zynq"), HasSubstr("links.ethernet.to"));
  EXPECT_THAT(error("main_node: pc", "main_node: px"), HasSubstr("main_node: is 'px'"));
  EXPECT_THAT(error("117.5e6", "-1"), HasSubstr("links.ethernet.bandwidth: -1"));
  EXPECT_EQ(error("    to: pc", "    to: pc\n    uncertainty: {value: 0.1, source: \"a guess\"}"),
            "");
  EXPECT_THAT(error("    to: pc", "    to: pc\n    uncertainty: {value: -1, source: \"a guess\"}"),
              HasSubstr("links.ethernet.uncertainty: -1"));
  EXPECT_THAT(error("  ethernet:", "  ethernet: &e\n    <<: 3"), HasSubstr("m.yaml:"));
  EXPECT_THAT(error("  pc:", "  ../pc:"), HasSubstr("not a name"));
}

TEST(Machines, AnUnknownNameListsWhatThereIs) {
  try {
    load_machine("dragonfy", kProfiles);
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("'dragonfy'"));
    EXPECT_THAT(
        e.what(),
        HasSubstr("cpu-only, dragonfly, gpu-only, h200, kv260-rtx, orin-nano, tx2, u250-rtx"));
  }
  EXPECT_THROW(load_machine("/no/such.yaml"), Error);
}

TEST(Hash, IsFnv1a64) {
  EXPECT_EQ(hash_bytes(""), "cbf29ce484222325");
  EXPECT_EQ(hash_bytes("a"), "af63dc4c8601ec8c");
}

}  // namespace
}  // namespace partita::profile
