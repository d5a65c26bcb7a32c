#include "host/tasks/fusion/outline.h"

#include <cmath>

#include "host/tasks/outline.h"

namespace partita::fusion {
namespace {

using runtime::HostSpec;
using runtime::Shape;
using tasks::count;

constexpr std::uint64_t kStates = 15;    ///< of a key-frame: pose, velocity, two biases
constexpr std::int64_t kWindow = 10;     ///< key-frames, as the back-end's window
constexpr std::int64_t kIterations = 4;  ///< of the window's Gauss-Newton

/// Pre-integration of each inertial sample: the mid-point rule on attitude (quaternion product and
/// normalisation), velocity and position takes about 80 multiply-adds and two special functions;
/// covariance F P F' (two products of 15 x 15 matrices) and the Jacobian F J (one more) take
/// 15^3 each.
const HostSpec& preintegrate_spec() {
  static const HostSpec spec{"preintegrate", "fusion", [](const Shape& shape) {
                               const std::uint64_t samples = count(shape, "samples");
                               const std::uint64_t matrix = kStates * kStates;
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_fma] = samples * (80 + 3 * matrix * kStates);
                               work[OpClass::double_add] = samples * matrix;
                               work[OpClass::double_special] = samples * 2;
                               tasks::set_traffic(work, samples * 32 + 2 * matrix * 8,
                                                  2 * matrix * 8);
                               return work;
                             }};
  return spec;
}

/// Gauss-Newton over the window: one inertial factor between neighbours (15 residuals, Jacobians of
/// 15 x 30: about 1,500 operations to evaluate, J'J of 30 x 30 symmetric from 15 rows), one pose
/// factor per key-frame (6 residuals, 6 x 6). The normal equations are block-tridiagonal: each
/// block's factorisation takes n^3 / 6, its neighbour's solve n^3 / 2 and update n^3 / 2,
/// forward and backward substitution 4 n^2.
const HostSpec& window_spec() {
  static const HostSpec spec{
      "window_update", "fusion", [](const Shape& shape) {
        const std::uint64_t keyframes = count(shape, "keyframes");
        const std::uint64_t iterations = count(shape, "iterations");
        constexpr std::uint64_t n = kStates;
        const std::uint64_t inertial = 1500 + 15 * (2 * n) * (2 * n + 1) / 2;
        const std::uint64_t pose = 200 + 6 * 6 * 7 / 2;
        const std::uint64_t solve = n * n * n / 6 + n * n * n + 4 * n * n;
        Work work;
        work.kind = WorkKind::serial;
        work[OpClass::double_fma] = iterations * keyframes * (inertial + pose + solve);
        work[OpClass::double_special] = iterations * keyframes * (2 * n + 10);
        tasks::set_traffic(work, keyframes * (n + 3 * n * n) * 8, keyframes * n * 8);
        work.read_issued *= iterations;
        return work;
      }};
  return spec;
}

}  // namespace

tasks::TaskExport outline(const tasks::Sensors& sensors) {
  const auto samples = static_cast<std::int64_t>(std::ceil(sensors.imu_hz / sensors.camera_hz));
  tasks::Program program;
  program.host(preintegrate_spec(), {{"samples", samples}});
  program.host(window_spec(), {{"keyframes", kWindow}, {"iterations", kIterations}});
  tasks::TaskExport task{.name = "fusion", .outline = true};
  task.frames = {program};
  // Position and attitude quaternion, velocity, and the pose's 6 x 6 covariance, in doubles.
  task.outputs = {{"pose", (7 + 3 + 36) * 8}};
  return task;
}

}  // namespace partita::fusion
