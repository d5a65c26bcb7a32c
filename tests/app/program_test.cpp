// The tasks' exported programs against what the tasks really enqueue: a run on the emulated machine
// is recorded, and command by command compared with the programs for the run's counts.
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/app/environment.h"
#include "host/app/pipeline.h"
#include "host/app/workload.h"
#include "host/tasks/detection/darknet_network.h"
#include "host/tasks/detection/kernels.h"
#include "host/tasks/detection/program.h"
#include "tests/app/program_lines.h"
#include "tests/host/darknet_networks.h"
#include "tests/host/io_temp_folder.h"

namespace partita::app {
namespace {

/// A few frames of the street. The second one is black, where both tasks give up early; the one
/// after it is searched for in the wide window.
class Street : public sensing::FrameSource {
 public:
  Street(int width, int height, std::size_t frames)
      : source_(sensing::open_scenario({.frames = frames, .width = width, .height = height})) {}
  std::string name() const override { return source_->name(); }
  const sensing::StereoCalibration& calibration() const override { return source_->calibration(); }
  std::size_t size() const override { return source_->size(); }
  std::int64_t timestamp_ns(std::size_t k) const override { return source_->timestamp_ns(k); }
  sensing::Frame frame(std::size_t k) const override {
    sensing::Frame frame = source_->frame(k);
    if (k == 1) {
      for (auto* image : {&frame.left, &frame.right}) {
        std::fill(image->pixels.begin(), image->pixels.end(), std::uint8_t{0});
      }
    }
    return frame;
  }

 private:
  std::unique_ptr<sensing::FrameSource> source_;
};

struct Case {
  const char* device;
  int width, height;
  std::size_t frames;
};

class Programs : public ::testing::TestWithParam<Case> {
 protected:
  Programs() { set_emulation({.machine = "dragonfly", .recording = true}); }
  testing::TempFolder temp_;
};

TEST_P(Programs, AreWhatTheTasksEnqueue) {
  const Case& c = GetParam();
  const Street street(c.width, c.height, c.frames);
  Pipeline pipeline({.machine = "dragonfly", .placement = {{c.device, c.device}}},
                    street.calibration());
  pipeline.warm_up();
  FrameFeed feed(street, street.size(), partition::kBranches.size(), FrameFeed::Pace::slowest);
  std::vector<std::uint64_t> arrivals;
  for (std::size_t k = 0; k < street.size(); ++k) arrivals.push_back(k * 100'000'000);
  const PipelineRun run = pipeline.run(
      feed, arrivals, [](auto, auto) {}, [](std::size_t) {});
  ASSERT_FALSE(run.error);
  const std::string file = temp_.file("record.jsonl");
  pipeline.session(Branch::scene).extension().export_record(file);
  const timeline::Record record = timeline::load_record(file);

  RunCounts counts{.origin = "a test", .width = c.width, .height = c.height};
  counts.frames = run.work(street.size());
  ASSERT_EQ(counts.frames.size(), street.size());
  // Through the file and back: it must hold all that matters.
  write_counts(temp_.file("work.json"), counts);
  const RunCounts read = read_counts(temp_.file("work.json"));
  EXPECT_EQ(read, counts);

  partition::Pipeline both = partition::load_pipeline("perception", places().profiles);
  resize(both, static_cast<std::uint32_t>(c.width), static_cast<std::uint32_t>(c.height));
  const partition::Workload workload = recorded_workload(both, read);
  std::vector<std::int64_t> frames;
  for (const FrameWork& frame : read.frames) frames.push_back(frame.frame);
  const auto variant = static_cast<std::size_t>(pipeline.session(Branch::scene).charged());
  expect_same(recorded(record, "localization"), exported(workload.tasks[0], frames, variant));
  expect_same(recorded(record, "scene"), exported(workload.tasks[1], frames, variant));
  EXPECT_TRUE(counts.frames[1].frontend.keypoints_left == 0 &&
              counts.frames[1].depth.views[0].triangles == 0)
      << "the black frame was to end early";
  EXPECT_TRUE(counts.frames[2].frontend.searches.front().wide);
}

/// A network that has every layer, on a GPU: its plan as a program against what a run enqueues.
TEST(NetworkProgram, IsWhatARunEnqueues) {
  set_emulation({.machine = "dragonfly", .recording = true});
  const testing::TempFolder temp;
  const runtime::Device device = runtime::select_device(runtime::find_devices(), "gpu");
  const runtime::Session session(device, detection::kernel_specs(),
                                 {.execute = runtime::Execute::fast});
  session.extension().bind_thread("network", 0, device);
  const auto model = io::darknet::parse_cfg(testing::kEveryLayerCfg, "net.cfg");
  detection::DarknetNetwork network(session, model, io::darknet::random_weights(model, 1));
  network.run(std::vector<float>(model.input.count(), 0.5F), 7);
  session.finish();
  session.extension().export_record(temp.file("record.jsonl"));
  std::vector<std::string> enqueued =
      recorded(timeline::load_record(temp.file("record.jsonl")), "network");
  // The weights came first, of no frame.
  const auto loading = [](const std::string& line) { return !line.starts_with("frame 7 "); };
  const auto first = std::find_if_not(enqueued.begin(), enqueued.end(), loading);
  enqueued.erase(enqueued.begin(), first);

  tasks::Program program;
  detection::add_network(program, network.plan());
  std::vector<std::string> expected;
  for (const tasks::Step& step : program.steps()) {
    if (step.kind == tasks::StepKind::kernel) {
      const Work work = step.kernel->declared_work(runtime::Variant::gpu, step.shape);
      expected.push_back(
          fmt::format("frame 7 detection kernel {} {}", step.kernel->name, described(work)));
    } else {
      const bool reads = step.kind == tasks::StepKind::read;
      const char* kind = reads ? "read" : "write";
      expected.push_back(fmt::format("frame 7 detection {}  {} B", kind, step.bytes));
      if (reads) expected.emplace_back("wait");
    }
  }
  if (!enqueued.empty() && enqueued.back() == "finish") enqueued.pop_back();  // the test's own
  expect_same(enqueued, expected);
  EXPECT_GT(expected.size(), 20u);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Programs,
                         ::testing::Values(Case{"cpu", 480, 288, 5}, Case{"gpu", 480, 288, 5},
                                           Case{"fpga", 480, 288, 5}, Case{"gpu", 1280, 720, 3},
                                           Case{"fpga", 1280, 720, 3}),
                         [](const auto& test) {
                           return fmt::format("{}_{}", test.param.device, test.param.width);
                         });

}  // namespace
}  // namespace partita::app
