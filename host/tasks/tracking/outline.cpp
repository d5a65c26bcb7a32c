#include "host/tasks/tracking/outline.h"

#include <bit>

#include "host/tasks/outline.h"

namespace partita::tracking {
namespace {

using runtime::HostSpec;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;
using tasks::ceil_div;
using tasks::count;

// A target's window (2.5 times its box, Henriques et al., TPAMI 2015) is scaled to 128 x 128
// pixels: 32 x 32 cells of 4 pixels, 31 channels of HOG (18 signed and 9 unsigned directions, 4
// textures).
constexpr std::int64_t kTargets = 10;
constexpr std::int64_t kPatch = 128, kCells = 32, kChannels = 31;
constexpr std::uint64_t kFloat = 4, kComplex = 8;
constexpr std::uint64_t kPlane = static_cast<std::uint64_t>(kCells * kCells);
constexpr std::uint64_t kTrackBytes = 40;  ///< box, velocity, class, identity, score

Shape targets_shape() {
  return {{"targets", kTargets}, {"planes", kTargets * kChannels}};
}

/// A work-group of 256 a target (of 128 a plane), or a work-item of it on the CPU.
LaunchGeometry target_geometry(Variant variant, const Shape& shape) {
  if (variant == Variant::fpga) return {};
  // Four groups share a target's rows.
  if (variant == Variant::gpu) return tasks::groups_of(4 * count(shape, "targets"), 256);
  return tasks::groups_of(count(shape, "targets"), 1);
}
LaunchGeometry plane_geometry(Variant variant, const Shape& shape) {
  if (variant == Variant::fpga) return {};
  return tasks::groups_of(count(shape, "planes"), variant == Variant::gpu ? 128 : 1);
}

/// Per pixel of the patch: bilinear sampling (3 fma, 4 conversions), gradient (2 subtractions),
/// magnitude (2 fma, a root), direction (9 projections and comparisons), four bilinear votes (8
/// operations). Per cell: energies of 2 x 2 blocks (18 fma, 4 roots), 4 normalisations of 27
/// directions with truncation and their sums (27 x 4 x 3), and the window function.
Work hog_work(Variant variant, const Shape& shape) {
  const std::uint64_t targets = count(shape, "targets");
  const std::uint64_t pixels = targets * static_cast<std::uint64_t>(kPatch * kPatch);
  const std::uint64_t cells = targets * kPlane;
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::float_fma] = pixels * (3 + 2 + 9 + 4) + cells * 18;
  work[OpClass::float_add] = pixels * (4 + 2 + 9 + 4) + cells * 27 * 4 * 2;
  work[OpClass::float_mul] = cells * (27 * 4 + kChannels);
  work[OpClass::float_special] = pixels + cells * 4;
  tasks::set_traffic(work, pixels, cells * kChannels * kFloat);
  work.read_issued = pixels * 4;
  if (variant == Variant::gpu) {
    work[OpClass::atomic] = pixels;  // of a pixel's four votes, three are summed beforehand
    work.local_bytes = pixels * 2 * kFloat + cells * 27 * 5 * kFloat;
  }
  if (variant == Variant::fpga) {
    work.add_loop(pixels, 1, static_cast<std::uint32_t>(targets * 100));
    work.add_loop(cells * 9, 1, static_cast<std::uint32_t>(targets * 60));
  }
  return work;
}

/// Two-dimensional transform of 32 x 32, forward or inverse: n^2 log2(n^2) / 2 butterflies, each a
/// complex product (2 mul, 2 fma) and two complex sums (4 add).
Work fft_work(Variant variant, const Shape& shape) {
  const std::uint64_t planes = count(shape, "planes");
  const auto stages = static_cast<std::uint64_t>(std::bit_width(kPlane) - 1);
  const std::uint64_t butterflies = planes * kPlane / 2 * stages;
  Work work;
  work.kind = WorkKind::gather;
  work[OpClass::float_mul] = butterflies * 2;
  work[OpClass::float_fma] = butterflies * 2;
  work[OpClass::float_add] = butterflies * 4;
  tasks::set_traffic(work, planes * kPlane * kComplex, planes * kPlane * kComplex);
  // A radix of four on the GPU: every second stage goes through local memory.
  if (variant == Variant::gpu) work.local_bytes = planes * kPlane * stages / 2 * 2 * kComplex;
  // Four butterflies a clock.
  if (variant == Variant::fpga) {
    work.add_loop(butterflies / 4, 1, static_cast<std::uint32_t>(planes * stages * 20));
  }
  return work;
}

/// Kernel correlation in the frequency domain: per channel and frequency a conjugate product added
/// up (4 fma) and two squared norms (4 fma); result a plane per target.
Work correlate_work(Variant variant, const Shape& shape) {
  const std::uint64_t targets = count(shape, "targets");
  const std::uint64_t products = targets * kPlane * static_cast<std::uint64_t>(kChannels);
  Work work;
  work.kind = WorkKind::stream;
  work[OpClass::float_fma] = products * 8;
  tasks::set_traffic(work, 2 * products * kComplex, targets * kPlane * kComplex);
  if (variant == Variant::fpga)
    work.add_loop(products, 1, static_cast<std::uint32_t>(targets * 60));
  return work;
}

/// exp(-(|x|^2 + |z|^2 - 2 c) / σ² n) of every place: 3 operations, an exponential.
Work gaussian_work(Variant variant, const Shape& shape) {
  const std::uint64_t places = count(shape, "targets") * kPlane;
  Work work;
  work.kind = WorkKind::stream;
  work[OpClass::float_fma] = places * 2;
  work[OpClass::float_mul] = places;
  work[OpClass::float_special] = places;
  tasks::set_traffic(work, places * kComplex, places * kComplex);
  if (variant == Variant::fpga) work.add_loop(places, 1, 60);
  return work;
}

/// The response's spectrum, alpha times the kernel's (4 fma).
Work respond_work(Variant variant, const Shape& shape) {
  const std::uint64_t places = count(shape, "targets") * kPlane;
  Work work;
  work.kind = WorkKind::stream;
  work[OpClass::float_fma] = places * 4;
  tasks::set_traffic(work, 2 * places * kComplex, places * kComplex);
  if (variant == Variant::fpga) work.add_loop(places, 1, 40);
  return work;
}

/// The response's largest value and its neighbours: a comparison a place.
Work peak_work(Variant variant, const Shape& shape) {
  const std::uint64_t targets = count(shape, "targets");
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::float_add] = targets * kPlane;
  tasks::set_traffic(work, targets * kPlane * kComplex, targets * 16);
  if (variant == Variant::gpu) work.local_bytes = targets * 256 * 2 * kFloat * 2;
  if (variant == Variant::fpga) work.add_loop(targets * kPlane, 1, 30);
  return work;
}

/// New coefficients y / (k + λ) (a complex division: 6 fma, 2 divisions), and model and
/// coefficients moved towards the new ones (2 fma each).
Work train_work(Variant variant, const Shape& shape) {
  const std::uint64_t places = count(shape, "targets") * kPlane;
  const std::uint64_t model = places * static_cast<std::uint64_t>(kChannels);
  Work work;
  work.kind = WorkKind::stream;
  work[OpClass::float_fma] = places * (6 + 2) + model * 2;
  work[OpClass::float_special] = places * 2;
  tasks::set_traffic(work, (2 * model + 3 * places) * kComplex, (model + places) * kComplex);
  if (variant == Variant::fpga) work.add_loop(model, 1, 80);
  return work;
}

struct Part {
  const char* name;
  Work (*work)(Variant, const Shape&);
  LaunchGeometry (*geometry)(Variant, const Shape&);
  std::uint64_t local_bytes;
  FpgaDesign design;
};

FpgaDesign design(std::initializer_list<OnChipBuffer> buffers,
                  std::initializer_list<std::pair<OpClass, std::uint32_t>> operators,
                  std::uint32_t ports) {
  FpgaDesign result;
  tasks::set_buffers(result, buffers);
  tasks::set_operators(result, operators);
  result.memory_ports = ports;
  return result;
}

KernelSpec make(const Part& part) {
  KernelSpec spec = tasks::outline_kernel("tracking", part.name);
  spec.geometry = part.geometry;
  spec.work = part.work;
  spec.gpu_local_bytes = part.local_bytes;
  spec.design = part.design;
  return spec;
}

using enum OpClass;

/// Operators as many as a loop's iteration has operations: all loops start one every cycle.
const KernelSpec& hog_spec() {
  static const KernelSpec spec =
      make({"hog", hog_work, target_geometry, 8 * 1024,
            design({{128, 32, 3, 2}, {1024, 32, 27, 2}},
                   {{float_fma, 20}, {float_add, 43}, {float_mul, 15}, {float_special, 2}}, 2)});
  return spec;
}
const KernelSpec& fft_spec() {
  static const KernelSpec spec =
      make({"fft", fft_work, plane_geometry, kPlane * kComplex,
            design({{kPlane / 8, 64, 8, 2}, {kPlane / 8, 64, 8, 2}, {512, 64, 4, 2}},
                   {{float_mul, 8}, {float_fma, 8}, {float_add, 16}}, 2)});
  return spec;
}
const KernelSpec& correlate_spec() {
  static const KernelSpec spec = make({"correlate", correlate_work, target_geometry, 0,
                                       design({{kPlane, 64, 1, 2}}, {{float_fma, 8}}, 3)});
  return spec;
}
const KernelSpec& gaussian_spec() {
  static const KernelSpec spec =
      make({"gaussian", gaussian_work, target_geometry, 0,
            design({}, {{float_fma, 2}, {float_mul, 1}, {float_special, 1}}, 2)});
  return spec;
}
const KernelSpec& respond_spec() {
  static const KernelSpec spec =
      make({"respond", respond_work, target_geometry, 0, design({}, {{float_fma, 4}}, 2)});
  return spec;
}
const KernelSpec& peak_spec() {
  static const KernelSpec spec =
      make({"peak", peak_work, target_geometry, 256 * 2 * kFloat, design({}, {{float_add, 1}}, 1)});
  return spec;
}
const KernelSpec& train_spec() {
  static const KernelSpec spec = make({"train", train_work, target_geometry, 0,
                                       design({}, {{float_fma, 10}, {float_special, 2}}, 3)});
  return spec;
}

/// Targets and detections put together: overlaps of all pairs (15 operations, a division), then the
/// Hungarian algorithm, n^3 steps of about four operations.
const HostSpec& associate_spec() {
  static const HostSpec spec{"associate", "tracking", [](const Shape& shape) {
                               const std::uint64_t n = count(shape, "detections");
                               const std::uint64_t pairs = n * count(shape, "targets");
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::float_add] = pairs * 12 + n * n * n * 4;
                               work[OpClass::float_mul] = pairs * 3;
                               work[OpClass::float_special] = pairs;
                               tasks::set_traffic(work, n * 24 + count(shape, "targets") * 40,
                                                  count(shape, "targets") * 40);
                               return work;
                             }};
  return spec;
}

/// From the patches under the boxes to their kernel correlation with the model (or themselves).
void correlate(tasks::Program& program, const Shape& shape, const Shape& one_plane) {
  program.launch(hog_spec(), shape);
  program.launch(fft_spec(), shape);
  program.launch(correlate_spec(), shape);
  program.launch(fft_spec(), one_plane);
  program.launch(gaussian_spec(), shape);
  program.launch(fft_spec(), one_plane);
}

}  // namespace

tasks::TaskExport outline(const tasks::Sensors& sensors) {
  const Shape shape = targets_shape();
  const Shape one_plane = shape.with("planes", kTargets);
  constexpr std::uint64_t kBoxes = static_cast<std::uint64_t>(kTargets) * 16;
  tasks::Program program;
  program.host(associate_spec(), {{"targets", kTargets}, {"detections", 20}});
  program.write(static_cast<std::uint64_t>(sensors.width) *
                static_cast<std::uint64_t>(sensors.height));  // the left picture
  program.write(kBoxes);
  correlate(program, shape, one_plane);
  program.launch(respond_spec(), shape);
  program.launch(fft_spec(), one_plane);
  program.launch(peak_spec(), shape);
  program.read(kBoxes);
  program.write(kBoxes);  // the model is trained where the targets are now
  correlate(program, shape, one_plane);
  program.launch(train_spec(), shape);
  program.finish();
  tasks::TaskExport task{.name = "tracking", .outline = true};
  task.kernels = {&hog_spec(),     &fft_spec(),  &correlate_spec(), &gaussian_spec(),
                  &respond_spec(), &peak_spec(), &train_spec()};
  task.frames = {program};
  task.outputs = {{"tracks", static_cast<std::uint64_t>(kTargets) * kTrackBytes}};
  return task;
}

}  // namespace partita::tracking
