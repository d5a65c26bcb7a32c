// Workloads: what a simulator may rely on is checked, and their hash covers everything.
#include "partition/graph/workload.h"

#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace partita::partition {
namespace {

using ::testing::HasSubstr;

Work launch() {
  Work work;
  work.groups = 4;
  work.group_items = 64;
  return work;
}

Workload small() {
  TaskWork depth;
  depth.name = "depth";
  depth.variants = {true, true, false};
  depth.works = {{launch(), launch(), Work{}}, {}};
  depth.frames = {{{.kind = StepKind::write, .bytes = 100},
                   {.kind = StepKind::kernel, .name = "sobel", .work = 0},
                   {.kind = StepKind::host, .name = "mesh", .work = 1},
                   {.kind = StepKind::read, .bytes = 200, .blocking = true},
                   {.kind = StepKind::finish}},
                  {}};
  depth.outputs = {{"disparity", 200}};
  TaskWork planning;
  planning.name = "planning";
  planning.host_only = true;
  planning.works = {{}};
  planning.frames = {{{.kind = StepKind::host, .name = "solve", .work = 0}}};
  return {.origin = "a test", .hash = {}, .tasks = {depth, planning}};
}

std::string error_of(const Workload& workload) {
  try {
    check(workload);
  } catch (const profile::Error& e) {
    return e.what();
  }
  return "";
}

TEST(Workloads, FindAndCount) {
  const Workload workload = small();
  EXPECT_EQ(error_of(workload), "");
  EXPECT_EQ(workload.find("planning"), &workload.tasks[1]);
  EXPECT_EQ(workload.find("plan"), nullptr);
  EXPECT_EQ(workload.frame_count(), 2u);
  EXPECT_EQ(Workload{}.frame_count(), 0u);
}

TEST(Workloads, ErrorsNameTaskFrameAndStep) {
  const struct {
    std::function<void(Workload&)> edit;
    const char* expected;
  } cases[] = {
      {[](Workload& w) { w.tasks[0].frames[0][1].work = 9; },
       "task depth, frame 0, step 1 (kernel sobel): work 9, expected less than 2"},
      {[](Workload& w) { w.tasks[0].variants[2] = true; },
       "step 1 (kernel sobel): no work-group in the fpga variant"},
      {[](Workload& w) { w.tasks[0].works[0][1].kind = WorkKind::count_; },
       "step 1 (kernel sobel): work of an unknown kind"},
      {[](Workload& w) { w.tasks[0].works[1][0].loop_count = 99; }, "step 2 (host mesh): work of"},
      {[](Workload& w) { w.tasks[0].frames[0][2].name = ""; }, "step 2 (host): has no name"},
      {[](Workload& w) { w.tasks[0].frames.clear(); }, "task depth: has no frames"},
      {[](Workload& w) { w.tasks[0].frames.resize(3), w.tasks[1].frames.resize(2); },
       "task planning: 2 frames, expected 1 or 3"},
      {[](Workload& w) { w.tasks[0].variants = {}; }, "task depth: has no variant"},
      {[](Workload& w) { w.tasks[1].variants[0] = true; }, "task planning: has variants"},
      {[](Workload& w) { w.tasks[1].frames[0].push_back({.kind = StepKind::write, .bytes = 1}); },
       "task planning, frame 0, step 1 (write): a step on a device"},
      {[](Workload& w) {
         w.tasks[0].outputs.push_back({"disparity", 1});
       },
       "output 'disparity'"},
      {[](Workload& w) { w.tasks[0].frames[0][0].kind = static_cast<StepKind>(77); },
       "task depth: a step of an unknown kind"},
      {[](Workload& w) { w.tasks[1] = w.tasks[0]; }, "task depth: twice"},
  };
  for (const auto& c : cases) {
    Workload workload = small();
    c.edit(workload);
    EXPECT_THAT(error_of(workload), HasSubstr(c.expected));
  }
}

TEST(Workloads, TheHashCoversEverything) {
  const std::string good = content_hash(small());
  EXPECT_EQ(good.size(), 16u);
  EXPECT_EQ(content_hash(small()), good);
  const std::function<void(Workload&)> edits[] = {
      [](Workload& w) { w.origin = "another"; },
      [](Workload& w) { w.tasks[0].name = "depths"; },
      [](Workload& w) { w.tasks[0].outline = true; },
      [](Workload& w) { w.tasks[1].host_only = false; },
      [](Workload& w) { w.tasks[0].variants[1] = false; },
      [](Workload& w) { w.tasks[0].works[0][1].ops[3] = 1; },
      [](Workload& w) { w.tasks[0].works[0][2].loops[7].depth = 1; },
      [](Workload& w) { w.tasks[0].frames[0][0].bytes = 101; },
      [](Workload& w) { w.tasks[0].frames[0][3].blocking = false; },
      [](Workload& w) { w.tasks[0].frames[0][1].name = "sobe"; },
      [](Workload& w) { w.tasks[0].frames[0][1].circuit.memory_ports = 2; },
      [](Workload& w) { w.tasks[0].frames.pop_back(); },
      [](Workload& w) { w.tasks[0].outputs[0].bytes = 1; },
      [](Workload& w) { w.tasks[0].area.dsp = 1; },
      [](Workload& w) { w.tasks[0].area_declared = true; },
      [](Workload& w) { std::swap(w.tasks[0], w.tasks[1]); },
  };
  for (const auto& edit : edits) {
    Workload workload = small();
    edit(workload);
    EXPECT_NE(content_hash(workload), good) << &edit - edits;
  }
}

}  // namespace
}  // namespace partita::partition
