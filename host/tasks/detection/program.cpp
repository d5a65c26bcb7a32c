#include "host/tasks/detection/program.h"

#include "host/tasks/detection/kernels.h"
#include "host/tasks/detection/steps.h"
#include "host/tasks/detection/yolov3.h"

namespace partita::detection {
namespace {

constexpr std::uint64_t kFloat = sizeof(float);
constexpr std::int64_t kCandidates = 200;  ///< boxes above the threshold, on a street
/// Of all pairs of candidates a fifth, say, is of one class.
constexpr std::int64_t kCompared = kCandidates * kCandidates / 2 / 5;
constexpr std::uint64_t kCandidateBytes = 24;  ///< box, score, class
constexpr std::uint64_t kDetections = 20;      ///< left after suppression

}  // namespace

void add_network(tasks::Program& program, const Plan& plan) {
  program.write(plan.buffers[0].layout.count() * kFloat);
  for (const PlannedStep& step : plan.steps) program.launch(spec_of(step.kernel), step.shape);
  for (const auto& [layer, map] : plan.outputs) {
    program.read(plan.buffers[map.buffer].layout.count() * kFloat);
  }
}

tasks::TaskExport export_task(const tasks::Sensors& /*sensors*/) {
  const io::darknet::Model model = yolov3();
  const Plan plan = make_plan(model);
  std::int64_t boxes = 0, classes = 0;
  for (const auto& [layer, map] : plan.outputs) {
    const io::darknet::Yolo& yolo = model.layers[layer].yolo;
    classes = yolo.classes;
    boxes += static_cast<std::int64_t>(map.extent.count()) / (5 + classes);
  }
  tasks::Program program;
  program.host(fit_spec(), {{"pixels", model.input.width * model.input.height}});
  add_network(program, plan);
  program.host(boxes_spec(), {{"anchors", boxes},
                              {"classes", classes},
                              {"candidates", kCandidates},
                              {"compared", kCompared}});
  tasks::TaskExport task{.name = "detection"};
  task.kernels = kernel_specs();
  task.frames = {program};
  task.outputs = {{"detections", kDetections * kCandidateBytes}};
  return task;
}

}  // namespace partita::detection
