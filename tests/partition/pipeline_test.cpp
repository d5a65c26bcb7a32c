// Pipelines: the shipped ones load and say what they are meant to; bad ones are refused in one line
// that names file, line and key.
#include "partition/graph/pipeline.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "partition/graph/workload.h"
#include "tests/devices/mutate.h"

namespace partita::partition {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kProfiles = PARTITA_SOURCE_DIR "/profiles";

std::string file_text(const std::string& name) {
  std::ifstream in(kProfiles + "/pipelines/" + name + ".yaml");
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string edited(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string error_of(const std::string& text) {
  try {
    parse_pipeline(text, "some/file.yaml");
  } catch (const profile::Error& e) {
    testing::expect_one_line(e.what());
    return e.what();
  }
  return "";
}

std::vector<std::string> names_of(const Pipeline& pipeline) {
  std::vector<std::string> names;
  for (const PipelineTask& task : pipeline.tasks) names.push_back(task.name);
  return names;
}

TEST(Pipelines, TheVehiclesIsSensingPerceptionPlanning) {
  const Pipeline pipeline = load_pipeline("dragonfly", kProfiles);
  EXPECT_EQ(pipeline.id, "dragonfly");
  EXPECT_THAT(names_of(pipeline), ElementsAre("sensing", "frontend", "backend", "fusion", "depth",
                                              "detection", "tracking", "planning"));
  EXPECT_EQ(pipeline.period_ns, 100'000'000u);
  EXPECT_EQ(pipeline.imu_hz, 200u);
  EXPECT_EQ(pipeline.tasks[0].sensor_bytes, 4u * 1280 * 720 + 640);
  EXPECT_TRUE(pipeline.tasks[0].inputs.empty());
  const PipelineTask& tracking = pipeline.tasks[pipeline.index_of("tracking")];
  ASSERT_EQ(tracking.inputs.size(), 2u);
  EXPECT_EQ(tracking.inputs[1].task, pipeline.index_of("detection"));
  EXPECT_EQ(tracking.inputs[1].output, "detections");
  EXPECT_EQ(pipeline.tasks[pipeline.index_of("detection")].every, 3u);
  EXPECT_EQ(pipeline.tasks[pipeline.index_of("backend")].every, 5u);
  EXPECT_EQ(pipeline.perception.size(), 3u);
  EXPECT_THAT(pipeline.outputs, ElementsAre(pipeline.index_of("planning")));
}

TEST(Pipelines, WhatRunsTodayIsTwoIndependentTasksAtTheSensors) {
  const Pipeline pipeline = load_pipeline(kProfiles + "/pipelines/perception.yaml", "");
  EXPECT_THAT(names_of(pipeline), ElementsAre("frontend", "depth"));
  for (const PipelineTask& task : pipeline.tasks) {
    EXPECT_TRUE(task.inputs.empty());
    EXPECT_EQ(task.sensor, "stereo");
    EXPECT_EQ(task.sensor_bytes, 2u * 1280 * 720);
    EXPECT_EQ(task.when_full, WhenFull::keep);
  }
  EXPECT_EQ(pipeline.tasks[0].branch, "localization");
  EXPECT_EQ(pipeline.tasks[1].branch, "scene");
}

TEST(Pipelines, TasksComeInTopologicalOrderWhateverTheFiles) {
  const std::string text =
      "description: d\nsource: none to speak of\ndate: 2026\n"
      "cameras: {rate: 10, width: 64, height: 64}\n"
      "tasks:\n"
      "  c: {inputs: [b.out]}\n"
      "  a: {sensor: {name: s, bytes: 1}}\n"
      "  b: {inputs: [a.out]}\n"
      "perception: [c]\noutputs: [c, a]\n";
  const Pipeline pipeline = parse_pipeline(text, "p.yaml");
  EXPECT_THAT(names_of(pipeline), ElementsAre("a", "b", "c"));
  EXPECT_EQ(pipeline.tasks[2].inputs[0].task, 1u);
  EXPECT_THAT(pipeline.perception, ElementsAre(2u));
  EXPECT_THAT(pipeline.outputs, ElementsAre(2u, 0u));
  const std::string cycle =
      error_of(edited(text, "{sensor: {name: s, bytes: 1}}", "{inputs: [c.out]}"));
  EXPECT_THAT(cycle, HasSubstr("some/file.yaml:"));
  EXPECT_THAT(cycle, HasSubstr("a cycle: "));
  EXPECT_THAT(cycle, HasSubstr("c <- b <- a"));
  EXPECT_THAT(error_of(edited(text, "b: {inputs: [a.out]}", "b: {inputs: [b.out]}")),
              HasSubstr("b <- b"));
}

TEST(Pipelines, ErrorsNameFileLineKeyAndWhatWasExpected) {
  const std::string good = file_text("dragonfly");
  ASSERT_EQ(error_of(good), "");
  const struct {
    const char *from, *to, *expected;
  } cases[] = {
      {"every: 3", "every: 0", "tasks.detection.every: 0, expected a whole number in [1, 1000]"},
      {"every: 3", "evry: 3", "expected perhaps 'every'"},
      {"every: 3", "every: 2.5", "tasks.detection.every: 2.5"},
      {"width: 1280", "width: 63", "cameras.width: 63"},
      {"{value: 10, unit: Hz", "{value: 10, unit: kHz", "expected 'Hz'"},
      {"{value: 10, unit: Hz", "{value: 0, unit: Hz", "cameras.rate: 0"},
      {"[sensing.stereo]", "[sensing]", "expected TASK.OUTPUT"},
      {"[sensing.stereo]", "[camera.stereo]", "no task 'camera', expected one of sensing, "},
      {"[sensing.stereo]", "[sensing.stereo, sensing.stereo]", "twice"},
      {"[sensing.stereo]", "[]", "is empty"},
      {"    inputs: [sensing.stereo]\n", "", "missing, expected 'inputs' or 'sensor'"},
      {"when_full: keep", "when_full: wait", "expected one of keep, drop_oldest, drop_newest"},
      {"{when_full: keep}", "{depth: 2, when_full: keep}", "such a queue has no bound"},
      {"depth: 3,", "depth: 1001,", "tasks.tracking.queue.depth: 1001"},
      {"outputs: [planning]", "outputs: [plan]", "outputs: no task 'plan'"},
      {"outputs: [planning]", "outputs: [planning, planning]", "twice"},
      {"outputs: [planning]", "outputs: []", "is empty"},
      {"host_only: true", "host_only: 1", "expected true or false"},
      {"  planning:\n", "  plan ning:\n", "is not a name"},
      {"description:", "descrption:", "unknown key"},
  };
  for (const auto& c : cases) {
    const std::string error = error_of(edited(good, c.from, c.to));
    EXPECT_THAT(error, HasSubstr("some/file.yaml:")) << c.to;
    EXPECT_THAT(error, HasSubstr(c.expected)) << c.to;
  }
}

TEST(Pipelines, AnUnknownNameListsWhatThereIs) {
  try {
    load_pipeline("nothing", kProfiles);
    FAIL();
  } catch (const profile::Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("expected one of dragonfly, perception"));
  }
}

TEST(Pipelines, OtherCamerasSendOtherPictures) {
  Pipeline pipeline = load_pipeline("dragonfly", kProfiles);
  resize(pipeline, 640, 480);
  EXPECT_EQ(pipeline.tasks[0].sensor_bytes, 4u * 640 * 480 + 640);
  EXPECT_EQ(pipeline.width, 640u);
  EXPECT_THROW(resize(pipeline, 640, 63), profile::Error);
}

Workload workload_for(const Pipeline& pipeline) {
  Workload workload;
  for (const PipelineTask& task : pipeline.tasks) {
    TaskWork work;
    work.name = task.name;
    work.host_only = task.host_only;
    workload.tasks.push_back(work);
  }
  for (const PipelineTask& task : pipeline.tasks) {
    for (const Input& input : task.inputs) {
      workload.tasks[input.task].outputs.push_back({input.output, 1});
    }
  }
  return workload;
}

TEST(Pipelines, AreHeldAgainstTheWorkload) {
  const Pipeline pipeline = load_pipeline("dragonfly", kProfiles);
  const auto message = [&](const Workload& workload) -> std::string {
    try {
      check(pipeline, workload);
    } catch (const profile::Error& e) {
      return e.what();
    }
    return "";
  };
  const Workload good = workload_for(pipeline);
  EXPECT_EQ(message(good), "");
  Workload bad = good;
  bad.tasks.back().name = "plan";
  EXPECT_THAT(message(bad), HasSubstr("task planning: not in the workload"));
  bad = good;
  bad.tasks[0].host_only = false;
  EXPECT_THAT(message(bad), HasSubstr("task sensing: host_only is true"));
  bad = good;
  bad.tasks[pipeline.index_of("depth")].outputs[0].name = "map";
  EXPECT_THAT(message(bad),
              HasSubstr("input depth.disparity: no such output, expected one of map"));
}

TEST(PipelineFuzz, LoadsOrThrowsOneLine) {
  std::mt19937 random(1);
  for (const char* name : {"dragonfly", "perception"}) {
    const std::string good = file_text(name);
    int refused = 0;
    for (int i = 0; i < 1500; ++i) {
      try {
        parse_pipeline(testing::mutated(good, random), "fuzz.yaml");
      } catch (const profile::Error& e) {
        ++refused;
        testing::expect_one_line(e.what());
      }
    }
    EXPECT_GT(refused, 300) << name;
  }
}

}  // namespace
}  // namespace partita::partition
