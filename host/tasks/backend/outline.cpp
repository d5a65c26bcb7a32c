#include "host/tasks/backend/outline.h"

#include "host/tasks/outline.h"

namespace partita::backend {
namespace {

using runtime::HostSpec;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;
using tasks::count;

// The window. Assumptions: a key-frame adds some hundred landmarks, a landmark is seen in four of
// the key-frames; the step is accepted in every iteration.
constexpr std::int64_t kWindow = 10;
constexpr std::int64_t kPoints = 1000;
constexpr std::int64_t kSeenIn = 4;
constexpr std::int64_t kIterations = 10;

constexpr std::uint64_t kPose = 6, kPoint = 3;  ///< parameters
constexpr std::uint64_t kFloat = 4;             ///< bytes; the device computes in single precision
constexpr std::uint64_t kPoseBytes = 12 * kFloat;               ///< rotation matrix and translation
constexpr std::uint64_t kObservationBytes = 2 * kFloat + 4;     ///< pixel; key-frame and point
constexpr std::uint64_t kCrossBytes = kPose * kPoint * kFloat;  ///< W, 6 x 3, per observation
constexpr std::uint64_t kBlockBytes = (6 + kPoint) * kFloat;    ///< V (symmetric) and b, per point
constexpr std::uint64_t kFrameBlockBytes = (21 + kPose) * kFloat;  ///< U and b, per key-frame
/// The circuits start an observation (a point, a pair of key-frames) every four cycles; a fourth of
/// its operations then exist side by side. On-chip memories are for the paper's 50 key-frames.
constexpr std::uint32_t kInterval = 4;
constexpr std::uint32_t kLargestWindow = 50;

Shape window_shape() {
  return {{"keyframes", kWindow},
          {"points", kPoints},
          {"observations", kPoints * kSeenIn},
          // Σ over the points of n (n + 1) / 2 for n key-frames that see it
          {"pairs", kPoints * kSeenIn * (kSeenIn + 1) / 2}};
}

/// S and its right-hand side: 6 unknowns per key-frame.
std::uint64_t reduced_bytes(std::uint64_t keyframes) {
  const std::uint64_t n = kPose * keyframes;
  return (n * (n + 1) / 2 + n) * kFloat;
}

/// JU: residual and Jacobians of every observation, and their products.
///   R p + t                       9 fma
///   perspective division          1 special, 4 mul, 2 fma; residual 2 add
///   d(pixel)/d(camera point)      4 entries; times R: 2 x 3 entries of 2 fma
///   d/d(rotation)                 times the cross product's matrix: 2 x 3 entries of 2 fma
///   robust weight                 2 fma, 1 special; scaling 2 x 9 Jacobian entries and residual:
///   20 mul V += Jp' Jp (6), b += Jp' r (3), W = Jc' Jp (18), U += Jc' Jc (21), b += Jc' r (6): 2
///   fma each
Work jacobian_work(Variant variant, const Shape& shape) {
  const std::uint64_t n = count(shape, "observations"), points = count(shape, "points");
  const std::uint64_t keyframes = count(shape, "keyframes");
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::float_fma] = n * (9 + 2 + 12 + 12 + 2 + 2 * (6 + 3 + 18 + 21 + 6));
  work[OpClass::float_mul] = n * 24;
  work[OpClass::float_add] = n * 4;
  work[OpClass::float_special] = n * 2;
  tasks::set_traffic(work, n * kObservationBytes + points * 12 + keyframes * kPoseBytes,
                     n * kCrossBytes + points * kBlockBytes + keyframes * kFrameBlockBytes);
  work.read_issued += n * (12 + kPoseBytes);
  if (variant == Variant::gpu) {
    // U and b of each key-frame are summed in local memory, then added once per work-group.
    const std::uint64_t groups = tasks::ceil_div(n, 128);
    work[OpClass::atomic] = n * (21 + kPose) / 4 + groups * keyframes * (21 + kPose);
    work.local_bytes = n * (21 + kPose) * 2 * kFloat;
  }
  if (variant == Variant::fpga) work.add_loop(n, kInterval, 220);
  return work;
}

/// SE: the points' unknowns eliminated.
///   invert V + λ                        9 fma, 12 mul, 1 special a point
///   Y = W V^-1, and b -= Y b_p          6 x 3 entries of 3 fma, 6 x 3 fma an observation
///   S(i, j) -= Y_i W_j'                 6 x 6 entries of 3 fma a pair of key-frames
Work schur_work(Variant variant, const Shape& shape) {
  const std::uint64_t n = count(shape, "observations"), points = count(shape, "points");
  const std::uint64_t keyframes = count(shape, "keyframes"), pairs = count(shape, "pairs");
  const std::uint64_t reduced = reduced_bytes(keyframes);
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::float_fma] = points * 9 + n * (54 + 18) + pairs * 108;
  work[OpClass::float_mul] = points * 12;
  work[OpClass::float_special] = points;
  tasks::set_traffic(work, n * kCrossBytes + points * kBlockBytes + keyframes * kFrameBlockBytes,
                     reduced);
  if (variant == Variant::gpu) {
    // A point's pairs are added to one S per work-group in local memory, those to the common one.
    const std::uint64_t groups = tasks::ceil_div(points, 25);
    work.local_bytes = pairs * 36 * 2 * kFloat + n * kCrossBytes * 2;
    work[OpClass::atomic] = groups * reduced / kFloat;
    work.written_issued = groups * reduced;
  }
  if (variant == Variant::fpga) {
    work.add_loop(points, kInterval, 150);
    work.add_loop(n, kInterval, 60);
    work.add_loop(pairs, kInterval, 60);
    work.add_loop(reduced / kFloat, 1, 20);  // writing S
  }
  return work;
}

/// CC: the points' steps (back-substitution), and the cost of the trial state.
///   W' δc                               6 x 3 fma an observation; V^-1 (b - …): 9 fma a point
///   projection and robust cost as in JU: 9 + 2 + 2 fma, 4 mul, 4 add, 2 special
Work cost_work(Variant variant, const Shape& shape) {
  const std::uint64_t n = count(shape, "observations"), points = count(shape, "points");
  const std::uint64_t keyframes = count(shape, "keyframes");
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::float_fma] = n * (18 + 13) + points * 9;
  work[OpClass::float_mul] = n * 4;
  work[OpClass::float_add] = n * 5 + points * 3;
  work[OpClass::float_special] = n * 2;
  tasks::set_traffic(
      work,
      n * (kObservationBytes + kCrossBytes) + points * (12 + kBlockBytes) + keyframes * kPoseBytes,
      points * 12 + 2 * kFloat);
  work.read_issued += n * kPoseBytes;
  if (variant == Variant::gpu) work.local_bytes = n * 2 * kFloat;
  if (variant == Variant::fpga) {
    work.add_loop(n, kInterval, 60);
    work.add_loop(n, kInterval, 120);
  }
  return work;
}

/// One work-item an observation on the GPU (a group of 64 for 25 points in SE).
LaunchGeometry observation_geometry(Variant variant, const Shape& shape) {
  if (variant == Variant::fpga) return {};
  const std::uint64_t each = variant == Variant::gpu ? 128 : 256;
  return tasks::groups_of(tasks::ceil_div(count(shape, "observations"), each),
                          variant == Variant::gpu ? each : 1);
}

LaunchGeometry point_geometry(Variant variant, const Shape& shape) {
  if (variant == Variant::fpga) return {};
  return tasks::groups_of(
      tasks::ceil_div(count(shape, "points"), variant == Variant::gpu ? 25 : 64),
      variant == Variant::gpu ? 64 : 1);
}

const KernelSpec& jacobian_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("backend", "jacobian_update");
    s.geometry = observation_geometry;
    s.work = jacobian_work;
    s.gpu_local_bytes = kWindow * kFrameBlockBytes;
    // U of every key-frame (27 memories), poses; of an observation's operations one fourth.
    tasks::set_buffers(s.design, {{kLargestWindow, 32, 27, 2}, {kLargestWindow, 32, 12, 2}});
    tasks::set_operators(s.design, {{OpClass::float_fma, 37},
                                    {OpClass::float_mul, 6},
                                    {OpClass::float_add, 1},
                                    {OpClass::float_special, 1}});
    s.design.memory_ports = 3;
    return s;
  }();
  return spec;
}

const KernelSpec& schur_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("backend", "schur_elimination");
    s.geometry = point_geometry;
    s.work = schur_work;
    s.gpu_local_bytes = 8192;  // S in tiles
    // S as 36 memories, one per entry of its 6 x 6 blocks; W and Y of one point's observations.
    tasks::set_buffers(s.design, {{kLargestWindow * (kLargestWindow + 1) / 2, 32, 36, 2},
                                  {kLargestWindow, 32, 18, 2},
                                  {kLargestWindow, 32, 18, 2}});
    tasks::set_operators(
        s.design,
        {{OpClass::float_fma, 3 + 18 + 27}, {OpClass::float_mul, 3}, {OpClass::float_special, 1}});
    s.design.memory_ports = 2;
    return s;
  }();
  return spec;
}

const KernelSpec& cost_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("backend", "cost");
    s.geometry = observation_geometry;
    s.work = cost_work;
    s.gpu_local_bytes = 128 * 2 * kFloat;
    tasks::set_buffers(s.design, {{kLargestWindow, 32, 12, 2}, {kLargestWindow, 32, 6, 2}});
    tasks::set_operators(s.design, {{OpClass::float_fma, 5 + 6},
                                    {OpClass::float_mul, 1},
                                    {OpClass::float_add, 2},
                                    {OpClass::float_special, 1}});
    s.design.memory_ports = 2;
    return s;
  }();
  return spec;
}

/// CFS: L L' of S + λ in doubles, n^3 / 6 multiply-adds, and two triangular solves of n^2 / 2.
const HostSpec& cholesky_spec() {
  static const HostSpec spec{"cholesky", "backend", [](const Shape& shape) {
                               const std::uint64_t n = kPose * count(shape, "keyframes");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_fma] = n * n * n / 6 + n * n;
                               work[OpClass::double_special] = 2 * n;
                               tasks::set_traffic(work, reduced_bytes(count(shape, "keyframes")),
                                                  n * kFloat);
                               return work;
                             }};
  return spec;
}

/// Trial poses: each the exponential map of its step (about 60 operations, four special functions)
/// times the pose, a product of 3 x 4 matrices.
const HostSpec& poses_spec() {
  static const HostSpec spec{"trial_poses", "backend", [](const Shape& shape) {
                               const std::uint64_t keyframes = count(shape, "keyframes");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_fma] = keyframes * (60 + 36);
                               work[OpClass::double_special] = keyframes * 4;
                               tasks::set_traffic(work, keyframes * 2 * kPoseBytes,
                                                  keyframes * kPoseBytes);
                               return work;
                             }};
  return spec;
}

/// GRE: the cost's decrease over the model's, δ' (λ δ + b) / 2, and the next λ.
const HostSpec& gain_spec() {
  static const HostSpec spec{"gain_ratio", "backend", [](const Shape& shape) {
                               const std::uint64_t n = kPose * count(shape, "keyframes");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_fma] = 2 * n + 10;
                               work[OpClass::double_special] = 3;
                               tasks::set_traffic(work, 2 * n * kFloat, 8);
                               return work;
                             }};
  return spec;
}

/// What crosses between device and host in every iteration is the reduced system and two numbers.
void iterate(tasks::Program& program, const Shape& shape) {
  const std::uint64_t poses = kWindow * kPoseBytes;
  program.launch(jacobian_spec(), shape);
  program.launch(schur_spec(), shape);
  program.read(reduced_bytes(kWindow));
  program.host(cholesky_spec(), shape);
  program.host(poses_spec(), shape);
  program.write(poses);
  program.write(kWindow * kPose * kFloat);  // their steps, for the back-substitution
  program.launch(cost_spec(), shape);
  program.read(2 * kFloat);  // the cost, and the points' share of the model's decrease
  program.host(gain_spec(), shape);
}

}  // namespace

tasks::TaskExport outline(const tasks::Sensors&) {
  const Shape shape = window_shape();
  const std::uint64_t observations = count(shape, "observations"), points = count(shape, "points");
  tasks::Program program;
  program.write(observations * kObservationBytes);
  program.write(points * kPoint * kFloat);
  program.write(kWindow * kPoseBytes);
  for (std::int64_t i = 0; i < kIterations; ++i) iterate(program, shape);
  program.read(points * kPoint * kFloat);
  tasks::TaskExport task{.name = "backend", .outline = true};
  task.kernels = {&jacobian_spec(), &schur_spec(), &cost_spec()};
  task.frames = {program};
  task.outputs = {{"window", kWindow * kPoseBytes + points * kPoint * kFloat}};
  return task;
}

}  // namespace partita::backend
