#include "host/tasks/detection/program.h"

#include "host/tasks/detection/kernels.h"
#include "host/tasks/detection/yolov3.h"
#include "host/tasks/outline.h"

namespace partita::detection {
namespace {

using runtime::HostSpec;
using runtime::Shape;
using tasks::count;

constexpr std::uint64_t kFloat = sizeof(float);
constexpr std::int64_t kCandidates = 200;      ///< boxes above the threshold, on a street
constexpr std::uint64_t kCandidateBytes = 24;  ///< box, score, class
constexpr std::uint64_t kDetections = 20;      ///< left after suppression

/// The picture, scaled to fit (bilinear: 3 fma of 4 pixels), to 0..1 (mul), three equal channels of
/// a grey picture; the rest is grey.
const HostSpec& letterbox_spec() {
  static const HostSpec spec{
      "letterbox", "detection", [](const Shape& shape) {
        const std::uint64_t pixels = count(shape, "side") * count(shape, "side");
        const std::uint64_t picture = count(shape, "width") * count(shape, "height");
        Work work;
        work.kind = WorkKind::stencil;
        work[OpClass::float_fma] = pixels * 3;
        work[OpClass::float_mul] = pixels;
        work[OpClass::float_add] = pixels * 6;  // conversions, clamping
        tasks::set_traffic(work, picture, pixels * 3 * kFloat);
        return work;
      }};
  return spec;
}

/// Boxes from the network's numbers. A logistic (exponential and division) of each box's
/// objectness; of those above the threshold, of the others but the two sizes, which take an
/// exponential, and the best class.
const HostSpec& decode_spec() {
  static const HostSpec spec{
      "decode", "detection", [](const Shape& shape) {
        const std::uint64_t boxes = count(shape, "boxes"), entries = count(shape, "entries");
        const std::uint64_t candidates = count(shape, "candidates");
        Work work;
        work.kind = WorkKind::reduce;
        work[OpClass::float_special] = 2 * boxes + 2 * candidates * entries;
        work[OpClass::float_add] = 2 * boxes + 2 * candidates * entries;
        work[OpClass::float_mul] = 4 * candidates;
        tasks::set_traffic(work, boxes * 64, candidates * kCandidateBytes);  // a cache line a box
        return work;
      }};
  return spec;
}

/// Non-maximum suppression: candidates sorted by score (n log n), then each against the better ones
/// of its class (a fifth of all, say): an overlap takes 15 operations and a division.
const HostSpec& suppress_spec() {
  static const HostSpec spec{"suppress", "detection", [](const Shape& shape) {
                               const std::uint64_t n = count(shape, "candidates");
                               const std::uint64_t pairs = n * n / 2 / 5;
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::int_add] = n * 10 * 3 + n * n / 2;
                               work[OpClass::float_add] = pairs * 12;
                               work[OpClass::float_mul] = pairs * 3;
                               work[OpClass::float_special] = pairs;
                               tasks::set_traffic(work, n * kCandidateBytes,
                                                  kDetections * kCandidateBytes);
                               return work;
                             }};
  return spec;
}

}  // namespace

void add_network(tasks::Program& program, const Plan& plan) {
  program.write(plan.buffers[0].layout.count() * kFloat);
  for (const PlannedStep& step : plan.steps) program.launch(spec_of(step.kernel), step.shape);
  for (const auto& [layer, map] : plan.outputs) {
    program.read(plan.buffers[map.buffer].layout.count() * kFloat);
  }
}

tasks::TaskExport export_task(const tasks::Sensors& sensors) {
  const io::darknet::Model model = yolov3();
  const Plan plan = make_plan(model);
  std::int64_t boxes = 0, entries = 0;
  for (const auto& [layer, map] : plan.outputs) {
    const io::darknet::Yolo& yolo = model.layers[layer].yolo;
    entries = 5 + yolo.classes;
    boxes += static_cast<std::int64_t>(map.extent.count()) / entries;
  }
  tasks::Program program;
  program.host(letterbox_spec(),
               {{"width", sensors.width}, {"height", sensors.height}, {"side", model.input.width}});
  add_network(program, plan);
  program.host(decode_spec(),
               {{"boxes", boxes}, {"entries", entries}, {"candidates", kCandidates}});
  program.host(suppress_spec(), {{"candidates", kCandidates}});
  tasks::TaskExport task{.name = "detection"};
  task.kernels = kernel_specs();
  task.frames = {program};
  task.outputs = {{"detections", kDetections * kCandidateBytes}};
  return task;
}

}  // namespace partita::detection
