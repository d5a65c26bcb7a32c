// The container format: exact round trips, and nothing but a clean error from damaged bytes.
#include <random>

#include <gtest/gtest.h>

#include "devices/layer/container.h"
#include "devices/layer/program_binary.h"

namespace partita::layer {
namespace {

Container example() {
  Container c;
  c.device = "zcu102";
  c.clock_mhz = 237.5;
  c.area = {177200, 82700, 785, 0, 109};
  c.build_options = "-DWIDTH=1280";
  c.text = "__kernel void detect(__global const uchar* image) { }\n// \xc3\xa9\n";
  for (const char* name : {"detect", "match"}) {
    ContainerKernel k;
    k.name = name;
    k.args = {{"image", "uchar*", "global"}, {"n", "int", "private"}};
    k.loops = {{"rows", 1, 31}, {"tail", 2, 7}};
    k.work_group = {1, 1, 1};
    k.design.buffer_count = 2;
    k.design.buffers[0] = {1280, 8, 7, 2};
    k.design.buffers[1] = {2048, 256, 1, 1};
    k.design.operators[0] = 96;
    k.design.compute_units = 2;
    k.area = {1, 2, 3, 4, 5};
    c.kernels.push_back(k);
  }
  return c;
}

TEST(Container, ComesBackAsItWas) {
  const Container before = example();
  const Container after = parse(serialize(before));
  EXPECT_EQ(after.device, before.device);
  EXPECT_EQ(after.clock_mhz, before.clock_mhz);
  EXPECT_EQ(after.area, before.area);
  EXPECT_EQ(after.build_options, before.build_options);
  EXPECT_EQ(after.text, before.text);
  ASSERT_EQ(after.kernels.size(), 2u);
  EXPECT_EQ(after.kernels[1].args, before.kernels[1].args);
  EXPECT_EQ(after.kernels[1].loops, before.kernels[1].loops);
  EXPECT_EQ(after.kernels[1].area, before.kernels[1].area);
  EXPECT_EQ(after.kernels[1].design.buffers[1].width_bits, 256u);
  EXPECT_EQ(after.kernels[1].design.operators, before.kernels[1].design.operators);
  EXPECT_EQ(serialize(after), serialize(before));
  ASSERT_NE(after.find("match"), nullptr);
  EXPECT_EQ(after.find("nothing"), nullptr);
}

TEST(Container, EveryTruncationIsRefused) {
  const std::string whole = serialize(example());
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_THROW(parse(whole.substr(0, n)), ContainerError) << n << " bytes";
  }
  EXPECT_THROW(parse(whole + "x"), ContainerError);
}

TEST(Container, EveryFlippedByteIsRefused) {
  const std::string whole = serialize(example());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x20);
    EXPECT_THROW(parse(damaged), ContainerError) << "byte " << i;
  }
}

std::uint64_t fnv(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

/// The example with another header, and sizes and checksum that match it.
std::string with_header(const std::string& header) {
  std::string out = serialize(example()).substr(0, 16);
  const std::string body = header + "text";
  for (const std::uint64_t v : {std::uint64_t{header.size()}, std::uint64_t{4}, fnv(body)}) {
    out.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  return out + body;
}

std::string header_of(const std::string& whole) {
  std::uint64_t bytes = 0;
  std::copy_n(whole.data() + 16, sizeof bytes, reinterpret_cast<char*>(&bytes));
  return whole.substr(40, bytes);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Container, AHeaderWithTheRightChecksumIsReadStrictly) {
  const std::string good = header_of(serialize(example()));
  EXPECT_NO_THROW(parse(with_header(good)));
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"clock_mhz\":237.5", "\"clock_mhz\":-1"},
           {"\"clock_mhz\":237.5", "\"clock_mhz\":\"fast\""},
           {"\"clock_mhz\"", "\"clock\""},
           {"\"device\":\"zcu102\"", "\"device\":7"},
           {"\"lut\":1,", "\"lut\":-1,"},
           {"\"lut\":1,", "\"lut\":1.5,"},
           {"\"name\":\"match\"", "\"name\":\"detect\""},
           {"\"work_group\":[1,1,1]", "\"work_group\":[0,1,1]"},
           {"\"work_group\":[1,1,1]", "\"work_group\":[1,1]"},
           {"\"build_options\":", "\"more\":1,\"build_options\":"}}) {
    EXPECT_THROW(parse(with_header(replaced(good, from, to))), ContainerError) << to;
  }
  EXPECT_THROW(parse(with_header("not json")), ContainerError);
  EXPECT_THROW(parse(with_header("[]")), ContainerError);
}

TEST(Container, RandomHeadersNeverDoMoreThanThrow) {
  std::mt19937 random(7);
  const std::string good = header_of(serialize(example()));
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string header = good;
    for (int edits = 0; edits < 3; ++edits) {
      const std::size_t at = random() % header.size();
      const std::string glyphs = "{}[]\",:0129-e.tfnx";
      header[at] = glyphs[random() % glyphs.size()];
    }
    try {
      parse(with_header(header));
    } catch (const ContainerError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(refused, 2000);
}

TEST(ProgramBinary, KnowsItsDeviceAndNoticesDamage) {
  const std::string payload = "the driver's binary";
  const auto bytes = std::as_bytes(std::span(payload.data(), payload.size()));
  const std::string wrapped = wrap_binary({"gtx1060", true, bytes});
  const auto span = [](const std::string& s) {
    return std::as_bytes(std::span(s.data(), s.size()));
  };
  const auto back = unwrap_binary(span(wrapped));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->device, "gtx1060");
  EXPECT_TRUE(back->keeps_arg_info);
  EXPECT_EQ(back->payload.size(), payload.size());
  for (std::size_t n = 0; n < wrapped.size(); ++n) {
    EXPECT_FALSE(unwrap_binary(span(wrapped.substr(0, n)))) << n;
  }
  std::string damaged = wrapped;
  damaged.back() ^= 1;
  EXPECT_FALSE(unwrap_binary(span(damaged)));
}

}  // namespace
}  // namespace partita::layer
