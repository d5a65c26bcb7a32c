// `partita run`: what it writes, that it is the same every time, and whatever the load or
// placement.
#include <atomic>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/image.h"
#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

class RunTest : public ::testing::Test {
 protected:
  /// A run over a small scenario; its summary.
  json run(const std::string& out, const std::vector<std::string>& more = {},
           int frames = 3) const {
    std::vector<std::string> words{
        "run", "--width", "480", "--height", "288", "--frames", std::to_string(frames)};
    words.insert(words.end(), more.begin(), more.end());
    return run_words(out, words);
  }
  /// The same frames from disk, where --rate says only when they arrive.
  json run_from_disk(const std::string& out, const std::vector<std::string>& more) const {
    if (!fs::exists(temp_.file("data"))) {
      EXPECT_EQ(partita({"generate", "--out", temp_.file("data"), "--frames", "8", "--width", "480",
                         "--height", "288", "--quiet"})
                    .status,
                0);
    }
    std::vector<std::string> words{"run", "--dataset", temp_.file("data")};
    words.insert(words.end(), more.begin(), more.end());
    return run_words(out, words);
  }
  json run_words(const std::string& out, std::vector<std::string> words) const {
    words.insert(words.end(), {"--quiet", "--out", temp_.file(out)});
    return partita_json(words);
  }
  std::string bytes(const std::string& out, const std::string& file) const {
    return bytes_of(temp_.file(out + "/" + file));
  }
  void expect_same_results(const std::string& a, const std::string& b) const {
    for (const char* file :
         {"trajectory.txt", "trajectory.tum", "work.json", "disparity/000000.png",
          "disparity/000001.png", "disparity/000002.png"}) {
      EXPECT_EQ(bytes(a, file), bytes(b, file)) << file << " of " << a << " and " << b;
    }
  }
  TempFolder temp_;
};

TEST_F(RunTest, WritesEverythingOnceAndWhole) {
  const json summary = run("out");
  for (const char* file :
       {"summary.json", "work.json", "trajectory.txt", "trajectory.tum", "trace.json",
        "overview.png", "disparity/000000.png", "disparity/000002.png"}) {
    EXPECT_TRUE(fs::exists(temp_.file(std::string("out/") + file))) << file;
  }
  EXPECT_FALSE(fs::exists(temp_.file("out/PARTIAL")));
  EXPECT_FALSE(fs::exists(temp_.file("out/disparity/000003.png")));
  EXPECT_EQ(summary, json::parse(bytes("out", "summary.json")));
  EXPECT_FALSE(summary["partial"]);
  EXPECT_EQ(summary["placement"]["localization"]["kind"], "fpga");
  EXPECT_EQ(summary["placement"]["scene"]["kind"], "gpu");
  EXPECT_EQ(summary["placement"]["scene"]["charged_variant"], "gpu");
  EXPECT_EQ(summary["placement"]["scene"]["executed_variant"], "cpu");
  EXPECT_GT(summary["predicted"]["latency"]["perception"]["mean_ns"], 0);
  EXPECT_EQ(summary["predicted"]["frames"].size(), 3u);
  EXPECT_GT(summary["predicted"]["energy"]["per_frame_j"], 0);
  EXPECT_EQ(summary["measured"]["scene"]["frames"].size(), 3u);
  EXPECT_TRUE(summary["accuracy"]["trajectory"].contains("end_error_percent"));
  for (const char* figure :
       {"density_where_truth", "bad1_percent", "bad3_percent", "mean_error_px"}) {
    EXPECT_TRUE(summary["accuracy"]["depth"].contains(figure)) << figure;
  }
}

TEST_F(RunTest, APerceivedFrameIsTheSlowerBranch) {
  const json summary = run("out");
  for (const json& frame : summary["predicted"]["frames"]) {
    EXPECT_EQ(frame["perception_ns"].get<std::uint64_t>(),
              std::max(frame["localization_ns"].get<std::uint64_t>(),
                       frame["scene_ns"].get<std::uint64_t>()));
  }
}

TEST_F(RunTest, TheTraceHasBothClocksApart) {
  run("out");
  const json trace = json::parse(bytes("out", "trace.json"));
  std::map<int, std::string> processes;
  std::map<int, int> events;
  for (const json& event : trace["traceEvents"]) {
    if (event["ph"] == "M" && event["name"] == "process_name") {
      processes[event["pid"]] = event["args"]["name"];
    }
    if (event["ph"] == "X") ++events[event["pid"]];
  }
  ASSERT_EQ(processes.size(), 2u);
  EXPECT_THAT(processes.begin()->second, HasSubstr("predicted"));
  EXPECT_THAT(processes.rbegin()->second, HasSubstr("measured"));
  for (const auto& [pid, name] : processes) EXPECT_GT(events[pid], 10) << name;
}

/// Keeps all cores busy while it lives.
class Load {
 public:
  Load() {
    for (unsigned i = 0; i < 2 * std::max(1u, std::thread::hardware_concurrency()); ++i) {
      threads_.emplace_back([this] {
        while (!stop_) {
        }
      });
    }
  }
  ~Load() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> stop_ = false;
  std::vector<std::thread> threads_;
};

TEST_F(RunTest, PredictedTimesAndResultsAreTheSameEveryTimeWhateverTheLoad) {
  const json first = run("first");
  const json second = run("second");
  EXPECT_EQ(first["predicted"], second["predicted"]);
  EXPECT_EQ(first["accuracy"], second["accuracy"]);
  EXPECT_EQ(first["input"], second["input"]);
  expect_same_results("first", "second");
  const Load load;
  EXPECT_EQ(run("loaded")["predicted"], first["predicted"]);
  expect_same_results("first", "loaded");
}

TEST_F(RunTest, BothBranchesOnOneDeviceAreDeterministicToo) {
  const std::vector<std::string> gpu{"--placement", "localization=gpu,scene=gpu"};
  const json first = run("first", gpu);
  const Load load;
  EXPECT_EQ(run("second", gpu)["predicted"], first["predicted"]);
}

TEST_F(RunTest, LatenessNeverChangesDataUnlessAsked) {
  run_from_disk("slow", {});
  const json fast = run_from_disk("fast", {"--rate", "5000"});
  EXPECT_GT(fast["predicted"]["late_frames"], 0);
  expect_same_results("slow", "fast");
}

TEST_F(RunTest, DroppingIsDeterministic) {
  const std::vector<std::string> words{"--rate", "5000", "--drop-late"};
  const json first = run_from_disk("first", words);
  EXPECT_FALSE(first["dropped_frames"]["scene"].empty());
  const Load load;
  const json second = run_from_disk("second", words);
  EXPECT_EQ(first["dropped_frames"], second["dropped_frames"]);
  EXPECT_EQ(first["predicted"], second["predicted"]);
  EXPECT_EQ(bytes("first", "trajectory.tum"), bytes("second", "trajectory.tum"));
}

TEST_F(RunTest, WhatOneFrameCannotSayIsAbsent) {
  const json one = run("out", {}, 1);
  EXPECT_TRUE(one["predicted"]["throughput_hz"].is_null());
  EXPECT_EQ(one["predicted"]["frames_in_common"], 1);
  EXPECT_TRUE(one["accuracy"]["trajectory"]["end_error_percent"].is_null());
  const Outcome text = partita(
      {"run", "--width", "480", "--height", "288", "--frames", "1", "--out", temp_.file("out")});
  EXPECT_THAT(text.out, HasSubstr("predicted rate      n/a"));
  EXPECT_THAT(text.out, HasSubstr("end error n/a"));
  EXPECT_THAT(text.err, ::testing::Not(HasSubstr("tracked")));
}

TEST_F(RunTest, LostTrackingIsSaid) {
  run_from_disk("whole", {});
  // Both cameras see nothing in mid-sequence: a black frame cannot be tracked.
  const std::string data = temp_.file("data");
  sensing::GrayImage black = io::read_gray(data + "/image_0/000003.png").image;
  std::fill(black.pixels.begin(), black.pixels.end(), std::uint8_t{0});
  for (const char* camera : {"/image_0", "/image_1"}) {
    io::write_gray(data + camera + "/000003.png", black);
  }
  const Outcome text = partita({"run", "--dataset", data, "--out", temp_.file("out")});
  EXPECT_EQ(text.status, 0);
  EXPECT_THAT(text.err, HasSubstr("partita: localization: tracked "));
  EXPECT_THAT(text.out, HasSubstr("localization: tracked "));
}

TEST_F(RunTest, NativeHasMeasuredFiguresOnly) {
  const json native = run("native", {"--machine", "native"});
  EXPECT_TRUE(native["predicted"].is_null());
  EXPECT_EQ(native["execute"], "own");
  run("emulated");
  expect_same_results("native", "emulated");
}

TEST_F(RunTest, AnEarlierRunsFolderIsUsedAgain) {
  run("out");
  run("out", {}, 2);
  EXPECT_FALSE(fs::exists(temp_.file("out/disparity/000002.png"))) << "an old picture was left";
  const Outcome failed =
      partita({"run", "--dataset", temp_.file("nowhere"), "--out", temp_.file("out"), "--quiet"});
  EXPECT_EQ(failed.status, 3);
  EXPECT_TRUE(fs::exists(temp_.file("out/summary.json"))) << "nothing ran, so nothing is replaced";
}

TEST_F(RunTest, ADeviceThatIsLostEndsTheRunInOneLine) {
  run("out");
  const Outcome lost =
      partita({"run", "--frames", "3", "--width", "480", "--height", "288", "--fault",
               "device=gtx1060:lost@100", "--quiet", "--out", temp_.file("out")});
  expect_one_line(lost, 4, {"GTX 1060", "CL_OUT_OF_RESOURCES"});
  EXPECT_FALSE(fs::exists(temp_.file("out/summary.json")) &&
               !fs::exists(temp_.file("out/PARTIAL")));
}

/// Every placement of both branches, with fast execution.
TEST_F(RunTest, ResultsDoNotDependOnThePlacement) {
  run("reference", {"--machine", "native"});
  for (const std::string localization : {"fpga", "gpu", "cpu"}) {
    for (const std::string scene : {"fpga", "gpu", "cpu"}) {
      const std::string placement = "localization=" + localization + ",scene=" + scene;
      run("out", {"--placement", placement});
      expect_same_results("reference", "out");
      ASSERT_FALSE(HasFailure()) << placement;
    }
  }
}

/// Whichever text computes them: same results, and the same times to the nanosecond.
TEST_F(RunTest, NeitherResultsNorPredictedTimesDependOnWhatIsExecuted) {
  for (const std::string device : {"fpga", "gpu", "cpu"}) {
    const std::string placement = "localization=" + device + ",scene=" + device;
    const json fast = run("fast", {"--placement", placement, "--execute", "fast"});
    const json own = run("own", {"--placement", placement, "--execute", "own"});
    expect_same_results("fast", "own");
    EXPECT_EQ(fast["predicted"], own["predicted"]) << placement;
  }
}

/// Intervals [start, end) of the measured lanes whose names hold `what`.
std::vector<std::pair<double, double>> executed(const json& trace, const std::string& what) {
  std::map<std::pair<int, int>, bool> lanes;
  std::vector<std::pair<double, double>> intervals;
  for (const json& event : trace["traceEvents"]) {
    if (event["ph"] == "M" && event["name"] == "thread_name") {
      const std::string name = event["args"]["name"];
      lanes[{event["pid"], event["tid"]}] =
          name.find("executed here") != std::string::npos && name.find(what) != std::string::npos;
    }
    if (event["ph"] == "X" && lanes[{event["pid"], event["tid"]}]) {
      intervals.emplace_back(event["ts"], event["ts"].get<double>() + event["dur"].get<double>());
    }
  }
  return intervals;
}

TEST_F(RunTest, TheDevicesKernelsOverlapInWallTime) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one core: nothing can overlap";
  run_words("out", {"run", "--frames", "6"});
  const json trace = json::parse(bytes("out", "trace.json"));
  const auto fpga = executed(trace, "zcu102"), gpu = executed(trace, "gtx1060");
  ASSERT_FALSE(fpga.empty());
  ASSERT_FALSE(gpu.empty());
  double overlap = 0;
  for (const auto& [a0, a1] : fpga) {
    for (const auto& [b0, b1] : gpu) overlap += std::max(0.0, std::min(a1, b1) - std::max(a0, b0));
  }
  EXPECT_GT(overlap, 0.0) << "no kernel of one device ran while one of the other did";
}

TEST_F(RunTest, Kitti) {
  const std::string data = data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA names no folder of real data";
  const json summary = partita_json(
      {"run", "--dataset", data + "/seq_kitti_odom_1", "--quiet", "--out", temp_.file("kitti")});
  EXPECT_EQ(summary["input"]["frames"], 51);
  EXPECT_LT(summary["accuracy"]["trajectory"]["end_error_percent"], 2.0);
  EXPECT_NEAR(summary["accuracy"]["trajectory"]["distance_m"].get<double>(), 59.9, 0.2);
  EXPECT_GT(summary["accuracy"]["depth"]["density"], 0.5);
}

TEST_F(RunTest, KittiIsTheSameOnEveryPlacement) {
  const std::string data = data_folder();
  if (data.empty()) GTEST_SKIP() << "PARTITA_DATA names no folder of real data";
  const auto run_kitti = [&](const std::string& out, const std::string& placement) {
    partita_json({"run", "--dataset", data + "/seq_kitti_odom_1", "--frames", "6", "--quiet",
                  "--out", temp_.file(out), "--placement", placement});
  };
  run_kitti("a", "localization=fpga,scene=gpu");
  run_kitti("b", "localization=gpu,scene=cpu");
  run_kitti("c", "localization=cpu,scene=fpga");
  expect_same_results("a", "b");
  expect_same_results("a", "c");
}

}  // namespace
}  // namespace partita::testing
