// Workloads from the tasks' programs: complete, plausible on every device, and without OpenCL.
#include "host/app/workload.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/model/area.h"
#include "devices/profile/machine.h"
#include "host/runtime/error.h"
#include "host/tasks/depth/program.h"
#include "host/tasks/detection/yolov3.h"
#include "host/tasks/frontend/program.h"
#include "tests/host/io_temp_folder.h"

namespace {
int opencl_calls = 0;
}

/// Stands in for the loader's: whoever wants to use OpenCL begins with this call.
extern "C" cl_int CL_API_CALL clGetPlatformIDs(cl_uint, cl_platform_id*, cl_uint*) {
  ++opencl_calls;
  return CL_INVALID_VALUE;
}

namespace partita::app {
namespace {

using partition::Step;
using partition::StepKind;
using partition::TaskWork;
using ::testing::HasSubstr;

const std::string kProfiles = PARTITA_SOURCE_PROFILES;

partition::Pipeline pipeline(const std::string& name = "dragonfly") {
  return partition::load_pipeline(name, kProfiles);
}

RunCounts small_run() {
  RunCounts run{.origin = "a test", .width = 640, .height = 360};
  for (std::int64_t k = 0; k < 3; ++k) {
    FrameWork frame{.frame = 2 * k,
                    .frontend = frontend::typical_counts(640, 360, {}),
                    .depth = depth::typical_counts(640, 360, depth::default_parameters(640))};
    frame.depth.support_points += k;
    run.frames.push_back(frame);
  }
  run.frames[0].frontend.searches.clear();
  return run;
}

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  } catch (const profile::Error& e) {
    return e.what();
  }
  return "";
}

TEST(AppWorkload, NeedsNoOpenCL) {
  typical_workload(pipeline());
  partition::Pipeline small = pipeline();
  resize(small, 640, 360);
  recorded_workload(small, small_run());
  EXPECT_EQ(opencl_calls, 0);
}

TEST(AppWorkload, HasEveryTaskOfThePipeline) {
  const partition::Workload workload = typical_workload(pipeline());
  EXPECT_EQ(workload.origin, "typical counts");
  EXPECT_EQ(workload.hash, partition::content_hash(workload));
  EXPECT_EQ(workload.hash, typical_workload(pipeline()).hash);
  EXPECT_EQ(workload.frame_count(), 1u);
  for (const TaskWork& task : workload.tasks) {
    const bool written = task.name == "frontend" || task.name == "depth" ||
                         task.name == "detection" || task.name == "tracking";
    EXPECT_EQ(task.outline, !written) << task.name;
    EXPECT_FALSE(task.outputs.empty()) << task.name;
    EXPECT_FALSE(task.frames[0].empty()) << task.name;
    for (const partition::Output& output : task.outputs) EXPECT_GT(output.bytes, 0u) << task.name;
    for (const bool has : task.variants) EXPECT_EQ(has, !task.host_only) << task.name;
  }
  EXPECT_EQ(workload.find("sensing")->outputs[0].bytes, 2u * 1280 * 720);
  EXPECT_EQ(workload.find("depth")->outputs[0].bytes, 2u * 1280 * 720);
}

/// Each Work on each device it may meet: it takes a time, and the sanity gate believes it.
TEST(AppWorkload, EveryWorkIsPlausibleOnEveryDevice) {
  const partition::Workload workload = typical_workload(pipeline());
  for (const std::string& name : profile::list_devices(kProfiles)) {
    const auto device = profile::load_device(kProfiles + "/devices/" + name + ".yaml");
    const model::DeviceModel model(device);
    for (const TaskWork& task : workload.tasks) {
      for (const Step& step : task.frames[0]) {
        const bool host = step.kind == StepKind::host;
        if (step.kind != StepKind::kernel && !host) continue;
        if (host && device.type != profile::DeviceType::cpu) continue;
        const Work& work = task.works[step.work][host ? 0 : partition::variant_index(device.type)];
        const model::Cost cost =
            host ? model.host_step(work)
                 : model.kernel(work, {work.groups, work.group_items, work.group_local_bytes},
                                step.circuit);
        EXPECT_GT(cost.busy_ns(), 0u) << task.name << " " << step.name;
        EXPECT_EQ(model::implausible(device, work, static_cast<double>(cost.total_ns()) * 1e-9,
                                     device.power.busy_w, 1),
                  "")
            << task.name << " " << step.name << " on " << name;
        if (!host && device.type == profile::DeviceType::fpga) {
          EXPECT_GT(work.loop_count, 0u) << task.name << " " << step.name;
        }
      }
    }
  }
}

TEST(AppWorkload, EveryTaskFitsTheFpgaByItselfAndNotAllTogether) {
  const auto fpga = profile::load_device(kProfiles + "/devices/zcu102.yaml");
  profile::Area all;
  for (const TaskWork& task : typical_workload(pipeline()).tasks) {
    EXPECT_EQ(model::misfit(task.area, fpga), "") << task.name;
    EXPECT_EQ(task.area == profile::Area{}, task.host_only) << task.name;
    all = model::operator+(all, task.area);
  }
  EXPECT_NE(model::misfit(all, fpga), "");
}

TEST(AppWorkload, RecordedFramesFollowOneAnother) {
  partition::Pipeline small = pipeline();
  resize(small, 640, 360);
  const RunCounts run = small_run();
  const partition::Workload workload = recorded_workload(small, run);
  EXPECT_EQ(workload.origin, "a test");
  EXPECT_EQ(workload.frame_count(), 3u);
  EXPECT_EQ(workload.find("depth")->frames.size(), 3u);
  EXPECT_EQ(workload.find("detection")->frames.size(), 1u);
  EXPECT_LT(workload.find("frontend")->frames[0].size(),
            workload.find("frontend")->frames[1].size());
  // Equal frames share their Work.
  EXPECT_EQ(workload.find("frontend")->frames[1], workload.find("frontend")->frames[2]);
  EXPECT_NE(workload.hash, typical_workload(small).hash);
  EXPECT_THAT(message([&] { recorded_workload(pipeline(), run); }),
              HasSubstr("pictures of 1280 x 720, expected 640 x 360 as the run had"));
}

TEST(AppWorkload, AnUnknownTaskListsThoseThereAre) {
  partition::Pipeline odd = pipeline("perception");
  odd.tasks[0].name = "parking";
  EXPECT_THAT(message([&] { typical_workload(odd); }),
              HasSubstr("no task 'parking', expected one of backend, depth, detection, frontend"));
}

TEST(RunCounts, GoThroughTheFileAndBack) {
  const testing::TempFolder folder;
  write_counts(folder.file("work.json"), small_run());
  EXPECT_EQ(read_counts(folder.file("work.json")), small_run());
}

TEST(RunCounts, WhatNoRunWritesIsRefusedWithItsPlace) {
  const testing::TempFolder folder;
  const std::string file = folder.file("work.json");
  write_counts(file, small_run());
  std::ifstream in(file);
  const std::string good((std::istreambuf_iterator<char>(in)), {});
  const struct {
    std::string from, to, expected;
  } cases[] = {
      {"\"width\": 640", "\"width\": 63", "work.json: width is 63, expected a whole number in [64"},
      {"\"frame\": 2", "\"frame\": 0", "frames[1]: frame is 0"},
      {"\"keypoints_left\": ", "\"keypoints_left\": -", "frames[0].frontend: keypoints_left is -"},
      {"\"wide\": false", "\"wide\": 0", "searches[0]: wide is not true or false"},
      {"\"spans\": ", "\"spans\": 0.", "views[0]: spans is 0."},
      {"\"spans\": ", "\"spans\": 1e9", "number overflow"},
      {"\"support_points\"", "\"support\"", "has no 'support_points'"},
      {"\"origin\": \"a test\"", "\"origin\": 1", "origin is no text"},
      {"\"searches\": []", "\"searches\": 1", "searches is no list"},
  };
  for (const auto& c : cases) {
    std::string text = good;
    ASSERT_NE(text.find(c.from), std::string::npos) << c.from;
    std::ofstream(file) << text.replace(text.find(c.from), c.from.size(), c.to);
    const std::string error = message([&] { read_counts(file); });
    EXPECT_THAT(error, HasSubstr(c.expected)) << c.to;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

/// The figures that the network's authors state: 75 convolutions, 65.9 billion operations.
TEST(Detection, TheNetworkIsYolov3) {
  std::int64_t convolutions = 0, multiply_adds = 0, weights = 0;
  for (const io::darknet::Layer& layer : detection::yolov3().layers) {
    if (layer.kind != io::darknet::LayerKind::convolutional) continue;
    ++convolutions;
    const std::int64_t window = layer.size * layer.size * layer.in.channels;
    multiply_adds += static_cast<std::int64_t>(layer.out.count()) * window;
    weights += window * layer.out.channels;
  }
  EXPECT_EQ(convolutions, 75);
  EXPECT_NEAR(2e-9 * static_cast<double>(multiply_adds), 65.9, 0.1);
  EXPECT_NEAR(1e-6 * static_cast<double>(weights), 61.9, 0.1);
}

}  // namespace
}  // namespace partita::app
