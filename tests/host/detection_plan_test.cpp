// What a network's plan promises: shortcuts and joined maps cost no launch, and maps share memory
// only when none of them is needed any more.
#include <gtest/gtest.h>

#include "host/io/darknet.h"
#include "host/tasks/detection/plan.h"
#include "host/tasks/detection/yolov3.h"
#include "tests/host/darknet_networks.h"
#include "tests/host/detection_reference.h"
#include "tests/host/io_temp_folder.h"

namespace partita::detection {
namespace {

void expect_sound(const Plan& plan) {
  for (std::size_t a = 0; a < plan.buffers.size(); ++a) {
    const PlannedBuffer& x = plan.buffers[a];
    EXPECT_GE(plan.slots[x.slot], x.layout.count());
    for (std::size_t b = a + 1; b < plan.buffers.size(); ++b) {
      const PlannedBuffer& y = plan.buffers[b];
      if (x.slot != y.slot) continue;
      EXPECT_TRUE(x.last_step < y.first_step || y.last_step < x.first_step)
          << "buffers " << a << " and " << b << " in slot " << x.slot;
    }
  }
  for (const PlannedStep& step : plan.steps) {
    EXPECT_LE(step.pad, plan.buffers[step.in.buffer].layout.border);
    const bool same = step.in.buffer == step.out.buffer;
    EXPECT_TRUE(!same ||
                step.in.first_channel + step.in.extent.channels <= step.out.first_channel ||
                step.out.first_channel + step.out.extent.channels <= step.in.first_channel)
        << "a step of layer " << step.layer << " overwrites its own input";
  }
  EXPECT_GE(plan.slot_numbers(), plan.live_numbers());
}

std::size_t all_numbers(const Plan& plan) {
  std::size_t sum = 0;
  for (const PlannedBuffer& buffer : plan.buffers) sum += buffer.layout.count();
  return sum;
}

TEST(Plan, OfEveryLayer) {
  const Plan plan = make_plan(io::darknet::parse_cfg(testing::kEveryLayerCfg, "net.cfg"));
  expect_sound(plan);
  std::size_t residuals = 0, additions = 0, copies = 0;
  for (const PlannedStep& step : plan.steps) {
    residuals += step.other && step.kernel == StepKernel::convolution;
    additions += step.kernel == StepKernel::add;
    copies += step.kernel == StepKernel::upsample && step.shape["stride"] == 1;
  }
  EXPECT_EQ(residuals, 2u);  // layers 4 and 15
  EXPECT_EQ(additions, 1u);  // layer 17: after a pooling
  // The half of a map that is joined as well as read (7), and what is joined twice (the route 9).
  EXPECT_EQ(copies, 2u);
  EXPECT_EQ(plan.outputs.size(), 2u);
}

TEST(Plan, NeedsAYoloLayer) {
  const auto model = io::darknet::parse_cfg(
      "[net]\nwidth=8\nheight=8\n[convolutional]\nactivation=linear\n", "a.cfg");
  EXPECT_EQ(testing::error_of([&] { make_plan(model); }), "a.cfg: no [yolo] layer");
}

TEST(Plan, OfRealNetworksSharesMemory) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA names no folder of real data";
  for (const testing::TestNetwork& network : testing::test_networks()) {
    const auto model = io::darknet::read_cfg(data + "/detect/" + network.cfg);
    const Plan plan = make_plan(model);
    expect_sound(plan);
    EXPECT_LT(plan.slot_numbers(), all_numbers(plan)) << network.name;
    EXPECT_LT(10 * plan.slot_numbers(), 13 * plan.live_numbers()) << network.name;
    for (const PlannedStep& step : plan.steps) EXPECT_NE(step.kernel, StepKernel::add);
  }
}

TEST(Plan, OfTheBuiltInYolov3IsThatOfItsFile) {
  const std::string data = testing::data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA names no folder of real data";
  const Plan file = make_plan(io::darknet::read_cfg(data + "/detect/cfg_only/yolov3.cfg"));
  const Plan built_in = make_plan(yolov3());
  ASSERT_EQ(built_in.steps.size(), file.steps.size());
  for (std::size_t i = 0; i < file.steps.size(); ++i) {
    EXPECT_EQ(built_in.steps[i].shape.to_string(), file.steps[i].shape.to_string()) << i;
  }
  EXPECT_EQ(built_in.slots, file.slots);
}

}  // namespace
}  // namespace partita::detection
