#include "host/tasks/sensing/outline.h"

#include <cmath>

#include "host/tasks/outline.h"

namespace partita::sensing {
namespace {

using runtime::HostSpec;
using runtime::Shape;
using tasks::count;

constexpr std::int64_t kPictures = 4;       ///< two stereo pairs
constexpr std::uint64_t kSampleBytes = 32;  ///< time stamp, three turn rates, three accelerations

/// The pictures are copied once, from the camera driver's buffers into the message that everybody
/// reads. The time stamps of the pictures are compared with the trigger's (they come from one
/// hardware trigger; a pair out of step is refused), the inertial samples are put in order.
const HostSpec& synchronise_spec() {
  static const HostSpec spec{
      "synchronise", "sensing", [](const Shape& shape) {
        const std::uint64_t bytes = count(shape, "pictures") * count(shape, "pixels");
        const std::uint64_t samples = count(shape, "samples");
        Work work;
        work.kind = WorkKind::stream;
        work[OpClass::int_add] = count(shape, "pictures") * 20 + samples * 10;
        tasks::set_traffic(work, bytes + samples * kSampleBytes, bytes + samples * kSampleBytes);
        return work;
      }};
  return spec;
}

}  // namespace

tasks::TaskExport outline(const tasks::Sensors& sensors) {
  const std::int64_t pixels = std::int64_t{sensors.width} * sensors.height;
  const auto samples = static_cast<std::int64_t>(std::ceil(sensors.imu_hz / sensors.camera_hz));
  tasks::Program program;
  program.host(synchronise_spec(),
               {{"pictures", kPictures}, {"pixels", pixels}, {"samples", samples}});
  tasks::TaskExport task{.name = "sensing", .outline = true};
  task.frames = {program};
  // The forward pair, which localization and depth share, and the samples since the last frame.
  task.outputs = {{"stereo", 2 * static_cast<std::uint64_t>(pixels)},
                  {"imu", static_cast<std::uint64_t>(samples) * kSampleBytes}};
  return task;
}

}  // namespace partita::sensing
