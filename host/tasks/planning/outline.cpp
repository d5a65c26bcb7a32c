#include "host/tasks/planning/outline.h"

#include "host/tasks/outline.h"

namespace partita::planning {
namespace {

using runtime::HostSpec;
using runtime::Shape;
using tasks::count;

constexpr std::int64_t kHorizon = 20;       ///< steps of 0.1 s
constexpr std::int64_t kIterations = 5;     ///< of sequential quadratic programming
constexpr std::int64_t kObstacles = 10;     ///< as many as there are tracks
constexpr std::int64_t kLanePoints = 500;   ///< of the lane-level map around the vehicle
constexpr std::int64_t kSamples = 64 * 64;  ///< disparities looked at for an obstacle's distance

/// Where the tracks' boxes are in the world: the median of each box's disparities by a histogram
/// (read, compare with none, count), then a projection.
const HostSpec& locate_spec() {
  static const HostSpec spec{"locate_obstacles", "planning", [](const Shape& shape) {
                               const std::uint64_t obstacles = count(shape, "obstacles");
                               const std::uint64_t samples = count(shape, "samples");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::int_add] = obstacles * (3 * samples + 512);
                               work[OpClass::double_fma] = obstacles * 12;
                               work[OpClass::double_special] = obstacles * 2;
                               tasks::set_traffic(work, obstacles * 2 * samples, obstacles * 32);
                               return work;
                             }};
  return spec;
}

/// State (x, y, heading, speed) and control (steering, acceleration): n = 4, m = 2. First the
/// nearest point of the lane for each step. Then each iteration linearises the bicycle model (four
/// special functions and about 40 operations a step), adds obstacle costs (ten operations for each
/// obstacle and step), solves the quadratic problem by a Riccati recursion, 2 n^3 + 4 n^2 m +
/// 3 n m^2 + m^3 multiply-adds a step, and rolls the model out three times for the line search.
const HostSpec& solve_spec() {
  static const HostSpec spec{
      "solve_mpc", "planning", [](const Shape& shape) {
        const std::uint64_t horizon = count(shape, "horizon");
        const std::uint64_t steps = count(shape, "iterations") * horizon;
        constexpr std::uint64_t n = 4, m = 2;
        constexpr std::uint64_t riccati = 2 * n * n * n + 4 * n * n * m + 3 * n * m * m + m * m * m;
        Work work;
        work.kind = WorkKind::serial;
        work[OpClass::double_fma] =
            horizon * count(shape, "lane_points") * 2 +
            steps * (40 + 10 * count(shape, "obstacles") + riccati + 3 * 30);
        work[OpClass::double_add] = horizon * count(shape, "lane_points") * 3;
        work[OpClass::double_special] = steps * (4 + m * m + 3 * 4);
        tasks::set_traffic(work, count(shape, "lane_points") * 16, horizon * (n + m) * 8);
        return work;
      }};
  return spec;
}

}  // namespace

tasks::TaskExport outline(const tasks::Sensors&) {
  tasks::Program program;
  program.host(locate_spec(), {{"obstacles", kObstacles}, {"samples", kSamples}});
  program.host(solve_spec(), {{"horizon", kHorizon},
                              {"iterations", kIterations},
                              {"obstacles", kObstacles},
                              {"lane_points", kLanePoints}});
  tasks::TaskExport task{.name = "planning", .outline = true};
  task.frames = {program};
  task.outputs = {{"commands", 3 * 16}};  // CAN frames: steering, drive, brake
  return task;
}

}  // namespace partita::planning
