// Durations and areas: worked examples, and what must hold for every device and every Work.
#include "devices/model/model.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/model/area.h"
#include "devices/profile/machine.h"

namespace partita::model {
namespace {

using profile::DeviceProfile;
using profile::DeviceType;

const std::string kProfiles = PARTITA_SOURCE_DIR "/profiles";

DeviceProfile load(const std::string& name) {
  return profile::load_device(kProfiles + "/devices/" + name + ".yaml");
}

Work random_work(std::mt19937& random, bool loops) {
  Work w;
  w.kind = static_cast<WorkKind>(random() % kWorkKinds);
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    const bool doubles = i >= 7 && i <= 10;
    if (!doubles && random() % 2 == 0) w.ops[i] = random() % 100'000'000;
  }
  w.read_unique = random() % 50'000'000;
  w.written_unique = random() % 50'000'000;
  w.read_issued = 2 * w.read_unique;
  w.written_issued = w.written_unique;
  w.local_bytes = random() % 100'000'000;
  if (loops) w.add_loop(random() % 10'000'000, 1 + random() % 3, 40);
  return w;
}

Launch random_launch(std::mt19937& random) {
  return {1 + random() % 2000, 1u << random() % 11, random() % 49'152};
}

TEST(Model, GpuIsBoundByMemoryOrBySlots) {
  const DeviceProfile gpu = load("gtx1060");
  const DeviceModel model(gpu);
  Work copy;
  copy.read_unique = copy.written_unique = 100'000'000;
  const Launch large{100'000, 256, 0};
  const Cost memory = model.kernel(copy, large);
  EXPECT_EQ(memory.bound, Bound::memory);
  EXPECT_NEAR(static_cast<double>(memory.memory_ns), 200e6 / (192.2 * 0.79), 2);
  EXPECT_EQ(memory.bytes, 200'000'000u);
  Work dense;
  dense.kind = WorkKind::dense;
  dense[OpClass::float_fma] = 1'000'000'000;
  const Cost compute = model.kernel(dense, large);
  EXPECT_EQ(compute.bound, Bound::compute);
  EXPECT_EQ(compute.heaviest, OpClass::float_fma);
  EXPECT_NEAR(static_cast<double>(compute.compute_ns), 1e9 / (1280 * 1.708 * 0.62), 2);
  EXPECT_EQ(model.kernel(Work{}, {1, 1, 0}).bound, Bound::launch);
}

TEST(Model, ASmallLaunchDoesNotFillTheGpu) {
  const DeviceModel model(load("gtx1060"));
  Work w;
  w[OpClass::float_add] = 10'000'000;
  const auto ns = [&](std::uint64_t groups) {
    return model.kernel(w, {groups, 256, 0}).compute_ns;
  };
  EXPECT_GT(ns(1), 9 * ns(10));   // one SM of ten
  EXPECT_GT(ns(10), 2 * ns(30));  // one group of 256 hides a third of the latency
  EXPECT_GT(ns(31), ns(30));      // a wave of which a tenth is used
  EXPECT_EQ(model.kernel(w, {1, 64, 0}).bound, Bound::occupancy);
  // Local memory limits how many groups are resident.
  EXPECT_GT(model.kernel(w, {1000, 128, 49'152}).compute_ns,
            model.kernel(w, {1000, 128, 0}).compute_ns);
}

TEST(Model, AnFpgaTakesItsCyclesOrItsPorts) {
  const DeviceModel model(load("zcu102"));
  Work w;
  w.add_loop(1'000'000, 1, 50);
  EXPECT_EQ(model.kernel(w, {}).compute_ns, 5'000'250u);  // 200 MHz
  EXPECT_EQ(model.kernel(w, {}, {250e6, 1, 1}).compute_ns, 4'000'200u);
  w.read_unique = 128'000'000;
  const Cost port = model.kernel(w, {}, {200e6, 1, 1});
  EXPECT_EQ(port.bound, Bound::port);
  EXPECT_EQ(port.memory_ns, 40'000'000u);  // 3.2 GB/s
  EXPECT_EQ(model.kernel(w, {}, {200e6, 8, 1}).bound, Bound::memory);
  Work foreign;  // no loops: one operation a cycle, or a word a port and cycle
  foreign[OpClass::int_add] = 1000;
  EXPECT_EQ(model.kernel(foreign, {}).compute_ns, 5000u);
  foreign.read_issued = 160'000;
  EXPECT_EQ(model.kernel(foreign, {}).compute_ns, 50'000u);
  foreign[OpClass::double_add] = 1;
  EXPECT_THROW(model.kernel(foreign, {}), profile::Error);
}

TEST(Model, ACpuSharesAmongItsCoresAndAHostStepHasOne) {
  const DeviceModel model(load("i5-8500"));
  Work w;
  w.kind = WorkKind::dense;
  w[OpClass::float_fma] = 1'000'000'000;
  const Cost all = model.kernel(w, {100, 1, 0}), one = model.kernel(w, {1, 1, 0});
  EXPECT_EQ(all.units, 6u);
  EXPECT_NEAR(static_cast<double>(one.compute_ns) / static_cast<double>(all.compute_ns), 6, 1e-4);
  const Cost step = model.host_step(w);
  EXPECT_EQ(step.compute_ns, one.compute_ns);
  EXPECT_EQ(step.launch_ns, 0u);
}

TEST(Model, AbsurdWorkIsRefused) {
  const DeviceModel model(load("i5-8500"));
  Work w;
  w[OpClass::int_add] = ~std::uint64_t{0};
  EXPECT_THROW(model.host_step(w), profile::Error);
  w = {};
  w.kind = static_cast<WorkKind>(77);
  EXPECT_THROW(model.kernel(w, {}), profile::Error);
  EXPECT_THROW(model.host_step(w), profile::Error);
}

TEST(Model, AFasterDeviceIsNeverSlower) {
  std::mt19937 random(3);
  for (const char* name : {"gtx1060", "zcu102", "i5-8500", "cortex-a53", "tx2-gpu", "tx2-cpu"}) {
    const DeviceProfile base = load(name);
    const DeviceModel slow(base);
    for (int i = 0; i < 500; ++i) {
      DeviceProfile better = base;
      auto& p = better.performance;
      switch (random() % 7) {
        case 0:
          p.clock_hz *= 1.5;
          break;
        case 1:
          p.units += better.type == DeviceType::fpga ? 0 : 1 + random() % 8;
          break;
        case 2:
          p.memory_bandwidth *= 1.3;
          break;
        case 3:
          p.ops_per_cycle[random() % kOpClasses] *= 2;
          break;
        case 4:
          p.local_bandwidth *= 2;
          break;
        case 5:
          better.host.launch_ns /= 2;
          break;
        default:
          p.max_items_per_unit *= 2;
          break;
      }
      const DeviceModel fast(better);
      const Work w = random_work(random, base.type == DeviceType::fpga && i % 2 == 0);
      const Launch launch = random_launch(random);
      EXPECT_LE(fast.kernel(w, launch).total_ns(), slow.kernel(w, launch).total_ns()) << name;
      Work more = w;
      more.ops[random() % 7] += random() % 1'000'000;
      more.read_unique += random() % 1'000'000;
      EXPECT_GE(slow.kernel(more, launch).total_ns(), slow.kernel(w, launch).total_ns()) << name;
    }
  }
}

TEST(Model, NoPredictionIsFasterThanTheRoofline) {
  std::mt19937 random(5);
  for (const char* name : {"gtx1060", "zcu102", "i5-8500", "tx2-gpu"}) {
    const DeviceProfile device = load(name);
    const DeviceModel model(device);
    for (int i = 0; i < 500; ++i) {
      const Work w = random_work(random, device.type == DeviceType::fpga);
      const Cost cost = model.kernel(w, random_launch(random));
      EXPECT_EQ(implausible(device, w, static_cast<double>(cost.total_ns()) * 1e-9, 1.0, 0.5), "");
    }
  }
}

TEST(Plausible, ImpossibleFiguresAreRefused) {
  const DeviceProfile gpu = load("gtx1060");
  Work w;
  w.read_unique = 192'200'000;  // a millisecond of its bus
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(implausible(gpu, w, 2e-3, nan, 1.0), "");
  EXPECT_THAT(implausible(gpu, w, 0.9e-3, 100, 0.5), ::testing::HasSubstr("roofline"));
  EXPECT_THAT(implausible(gpu, w, 0, 100, 0.5), ::testing::HasSubstr("time"));
  EXPECT_THAT(implausible(gpu, w, nan, 100, 0.5), ::testing::HasSubstr("time"));
  EXPECT_THAT(implausible(gpu, w, 2e-3, 0, 0.5), ::testing::HasSubstr("power of 0"));
  EXPECT_THAT(implausible(gpu, w, 2e-3, 1000, 0.5), ::testing::HasSubstr("at most"));
  EXPECT_THAT(implausible(gpu, w, 2e-3, 100, 1.01), ::testing::HasSubstr("utilisation"));
  EXPECT_THAT(implausible(gpu, w, 2e-3, 100, nan), ::testing::HasSubstr("utilisation"));
}

FpgaDesign random_design(std::mt19937& random) {
  FpgaDesign d;
  d.buffer_count = random() % kMaxBuffers;
  for (std::uint32_t i = 0; i < d.buffer_count; ++i) {
    d.buffers[i] = {random() % 5000, static_cast<std::uint32_t>(random() % 80),
                    static_cast<std::uint32_t>(random() % 9),
                    static_cast<std::uint32_t>(random() % 5)};
  }
  for (auto& n : d.operators) n = random() % 20;
  d.operand_bits = random() % 40;
  d.memory_ports = random() % 5;
  d.compute_units = random() % 3;
  return d;
}

TEST(Area, NeverDecreasesWhenADesignGrows) {
  std::mt19937 random(7);
  for (int i = 0; i < 3000; ++i) {
    const FpgaDesign d = random_design(random);
    FpgaDesign more = d;
    const std::size_t b = random() % kMaxBuffers;
    switch (random() % 8) {
      case 0:
        more.buffers[b].depth += random() % 2000;
        break;
      case 1:
        more.buffers[b].width_bits += random() % 40;
        break;
      case 2:
        more.buffers[b].banks += random() % 4;
        break;
      case 3:
        more.buffers[b].ports += random() % 4;
        break;
      case 4:
        more.operators[random() % kOpClasses] += random() % 5;
        break;
      case 5:
        more.operand_bits += random() % 20;
        break;
      case 6:
        more.memory_ports += random() % 4;
        break;
      default:
        more.compute_units += random() % 3;
        break;
    }
    const profile::Area a = estimate_area(d), c = estimate_area(more);
    EXPECT_LE(a.lut, c.lut);
    EXPECT_LE(a.ff, c.ff);
    EXPECT_LE(a.bram36, c.bram36);
    EXPECT_LE(a.dsp, c.dsp);
  }
}

TEST(Area, MemoriesTakeTheBlocksTheirShapeNeeds) {
  const auto blocks = [](std::uint64_t depth, std::uint32_t width, std::uint32_t banks) {
    FpgaDesign d, none;
    d.buffers[0] = {depth, width, banks, 2};
    d.buffer_count = 1;
    return estimate_area(d).bram36 - estimate_area(none).bram36;
  };
  EXPECT_EQ(blocks(1024, 36, 1), 1u);
  EXPECT_EQ(blocks(1025, 36, 1), 2u);
  EXPECT_EQ(blocks(512, 72, 1), 1u);
  EXPECT_EQ(blocks(1280, 8, 7), 7u);
  EXPECT_EQ(blocks(32, 8, 4), 0u);  // made of LUTs
  EXPECT_EQ(blocks(4096, 36, 1), 4u);
}

TEST(Area, WhatDoesNotFitSaysWhy) {
  const DeviceProfile fpga = load("zcu102");
  EXPECT_TRUE(fits({274'080, 548'160, 912, 0, 2520}, fpga));
  EXPECT_THAT(misfit({1, 1, 913, 0, 1}, fpga),
              ::testing::HasSubstr("913 BRAM36, expected at most 912"));
  EXPECT_FALSE(fits({1, 1, 1, 1, 1}, fpga));  // it has no URAM
}

}  // namespace
}  // namespace partita::model
