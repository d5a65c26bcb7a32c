// The tracking task's program against what Tracker really enqueues, as in program_test.cpp.
#include <gtest/gtest.h>

#include "host/app/environment.h"
#include "host/app/packager.h"
#include "host/runtime/device.h"
#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/program.h"
#include "tests/app/program_lines.h"
#include "tests/host/io_temp_folder.h"

namespace partita::app {
namespace {

class TrackingProgram : public ::testing::TestWithParam<const char*> {
 protected:
  TrackingProgram() { set_emulation({.machine = "dragonfly", .recording = true}); }
  testing::TempFolder temp_;
};

TEST_P(TrackingProgram, IsWhatTheTaskEnqueues) {
  constexpr int kWidth = 320, kHeight = 200;
  const runtime::Device device = runtime::select_device(runtime::find_devices(), GetParam());
  runtime::SessionOptions options;
  if (!device.accepts_source) {
    options.container = container_for(device, "dragonfly", runtime::Execute::own, "",
                                      tracking::kernel_specs());
  }
  const runtime::Session session(device, tracking::kernel_specs(), options);
  session.extension().bind_thread("tracking", 0, device);
  tracking::Tracker tracker(session, kWidth, kHeight);
  session.extension().bind_thread("frames", 0, device);
  // Nothing yet; two targets appear, one of them large; they are followed; one more; all are
  // missed.
  using Detections = std::vector<tracking::Detection>;
  const Detections two{{{30, 40, 20, 30}, 1, 0}, {{100, 10, 180, 170}, 1, 0}};
  const Detections three{two[0], two[1], {{20, 120, 30, 30}, 1, 0}};
  const std::vector<std::optional<Detections>> detections{std::nullopt, two, std::nullopt, three,
                                                          Detections{}};
  sensing::GrayImage image(kWidth, kHeight);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<std::uint8_t>(i * i / 97 % 251);
  }
  std::vector<tracking::FrameCounts> counts;
  std::vector<std::int64_t> frames;
  for (const auto& seen : detections) {
    frames.push_back(static_cast<std::int64_t>(frames.size()));
    std::optional<std::span<const tracking::Detection>> given;
    if (seen) given = std::span<const tracking::Detection>(*seen);
    tracker.update(image, given, frames.back());
    counts.push_back(tracker.counts());
  }
  EXPECT_EQ(counts[0].located, 0);
  EXPECT_EQ(counts[2].located, 2);
  EXPECT_EQ(counts[3].trained, 3);
  const std::string file = temp_.file("record.jsonl");
  session.extension().export_record(file);
  const timeline::Record record = timeline::load_record(file);
  const partition::TaskWork task = to_work(tracking::export_task(kWidth, kHeight, {}, counts));
  expect_same(recorded(record, "frames"),
              exported(task, frames, static_cast<std::size_t>(session.charged())));
}

INSTANTIATE_TEST_SUITE_P(Devices, TrackingProgram, ::testing::Values("cpu", "gpu", "fpga"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace partita::app
