#include "host/tasks/detection/outline.h"

#include "host/tasks/detection/network.h"
#include "host/tasks/outline.h"

namespace partita::detection {
namespace {

using runtime::HostSpec;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;
using tasks::ceil_div;
using tasks::count;

constexpr std::uint64_t kFloat = 4;
constexpr std::int64_t kCandidates = 200;      ///< boxes above the threshold, on a street
constexpr std::uint64_t kCandidateBytes = 24;  ///< box, score, class
constexpr std::uint64_t kDetections = 20;      ///< left after suppression

// GPU: a work-group of 64 computes 64 pixels x 64 channels, 8 x 8 a work-item; half as many
// channels in layers with too few tiles to fill a machine. The reduction is not split among
// work-groups: a result is one chain of multiply-adds in the same order in every variant.
constexpr std::uint64_t kTile = 64, kTileItems = 64, kTilesToFill = 120;
// FPGA: 13 pixels x 32 channels, one fused multiply-add unit each. A unit's latency is hidden by
// taking ten tiles of pixels in turn. 416 units of 5 DSP blocks fit a ZU9EG (2,520), 13 divides all
// maps.
constexpr std::uint64_t kPixels = 13, kChannels = 32;

struct Convolution {
  std::uint64_t pixels, inputs, outputs, window, stride;
  bool shortcut;

  std::uint64_t read() const {
    const std::uint64_t input = pixels * stride * stride * inputs;
    return (input + inputs * outputs * window + 2 * outputs + (shortcut ? written() : 0)) * kFloat;
  }
  std::uint64_t written() const { return pixels * outputs; }
  std::uint64_t tile_channels() const {
    return ceil_div(pixels, kTile) * ceil_div(outputs, kTile) < kTilesToFill ? kTile / 2 : kTile;
  }
  std::uint64_t tiles() const {
    return ceil_div(pixels, kTile) * ceil_div(outputs, tile_channels());
  }
};

Convolution convolution_of(const Shape& shape) {
  const std::uint64_t side = count(shape, "side"), kernel = count(shape, "kernel");
  return {side * side,     count(shape, "inputs"), count(shape, "outputs"),
          kernel * kernel, count(shape, "stride"), shape["shortcut"] != 0};
}

/// A multiply-add for each output, input channel and tap; then scale and bias (batch normalisation
/// folded: one fma), leaky ReLU (multiply, maximum), and the shortcut's sum.
Work convolution_work(Variant variant, const Shape& shape) {
  const Convolution c = convolution_of(shape);
  const std::uint64_t results = c.written(), chain = c.inputs * c.window;
  Work work;
  work.kind = WorkKind::dense;
  work[OpClass::float_fma] = results * (chain + 1);
  work[OpClass::float_mul] = results;
  work[OpClass::float_add] = results * (c.shortcut ? 2 : 1);
  tasks::set_traffic(work, c.read(), results * kFloat);
  if (variant == Variant::gpu) {
    // Tiles are whole: what sticks out is computed as well. Each of the chain's steps brings pixels
    // and channels of a tile into local memory, of which every work-item reads an eighth.
    const std::uint64_t steps = c.tiles() * chain, side = kTile + c.tile_channels();
    work[OpClass::float_fma] = steps * kTile * c.tile_channels() + results;
    work.local_bytes = steps * (side + kTileItems * side / 8) * kFloat;
    work.read_issued = steps * side * kFloat + (c.shortcut ? results * kFloat : 0);
  } else if (variant == Variant::fpga) {
    const std::uint64_t tiles = ceil_div(c.pixels, kPixels) * ceil_div(c.outputs, kChannels);
    work.add_loop(tiles * chain, 1, 60);
    work.add_loop(tiles, kPixels, 40);  // results leave 32 channels at a time
  } else {
    // A work-item computes 12 pixels x 32 channels: weights are asked for once per 12 pixels.
    work.read_issued =
        ceil_div(c.pixels, 12) * chain * (c.outputs + 12 * ceil_div(c.outputs, 32)) * kFloat;
  }
  return work;
}

LaunchGeometry convolution_geometry(Variant variant, const Shape& shape) {
  const Convolution c = convolution_of(shape);
  if (variant == Variant::fpga) return {};
  if (variant == Variant::gpu) return tasks::groups_of(c.tiles(), kTileItems);
  return tasks::groups_of(ceil_div(c.pixels, 12) * ceil_div(c.outputs, 32), 1);
}

const KernelSpec& convolution_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("detection", "convolution");
    s.geometry = convolution_geometry;
    s.work = convolution_work;
    s.gpu_local_bytes = 2 * 2 * kTile * 8 * kFloat;  // two stages of eight steps
    // Weights of 32 channels for the longest chain (1,024 x 9), read by all pixels' units; three
    // rows of the input for 13 pixels; accumulators of ten tiles.
    tasks::set_buffers(s.design, {{1024 * 9, 32, kChannels, 2},
                                  {3 * 28 * 1024 / kPixels, 32, kPixels, 2},
                                  {10, 32, kPixels * kChannels, 2}});
    tasks::set_operators(s.design, {{OpClass::float_fma, kPixels * kChannels},
                                    {OpClass::float_mul, kChannels},
                                    {OpClass::float_add, 2 * kChannels}});
    s.design.memory_ports = 4;
    return s;
  }();
  return spec;
}

/// One work-item a number on the GPU, one a row of the map on the CPU.
LaunchGeometry map_geometry(Variant variant, const Shape& shape) {
  const std::uint64_t side = count(shape, "side");
  if (variant == Variant::fpga) return {};
  if (variant == Variant::cpu) return tasks::groups_of(side, 1);
  return tasks::groups_of(ceil_div(side * side * count(shape, "outputs"), 256), 256);
}

/// The picture, scaled to fit (bilinear: 3 fma of 4 pixels), to 0..1 (mul), three equal channels of
/// a grey picture; the rest is grey.
Work letterbox_work(Variant variant, const Shape& shape) {
  const std::uint64_t pixels = count(shape, "side") * count(shape, "side");
  const std::uint64_t picture = count(shape, "width") * count(shape, "height");
  Work work;
  work.kind = WorkKind::stencil;
  work[OpClass::float_fma] = pixels * 3;
  work[OpClass::float_mul] = pixels;
  work[OpClass::float_add] = pixels * 6;  // conversions, clamping
  tasks::set_traffic(work, picture, pixels * 3 * kFloat);
  work.read_issued = pixels * 4;
  if (variant == Variant::fpga) work.add_loop(picture, 1, 60);  // streamed, as it lies in memory
  return work;
}

const KernelSpec& letterbox_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("detection", "letterbox");
    s.geometry = map_geometry;
    s.work = letterbox_work;
    tasks::set_buffers(s.design, {{4096, 8, 2, 2}});
    tasks::set_operators(
        s.design, {{OpClass::float_fma, 3}, {OpClass::float_mul, 1}, {OpClass::float_add, 6}});
    s.design.memory_ports = 2;
    return s;
  }();
  return spec;
}

/// Each number four times.
Work upsample_work(Variant variant, const Shape& shape) {
  const std::uint64_t results =
      count(shape, "side") * count(shape, "side") * count(shape, "outputs");
  Work work;
  work.kind = WorkKind::stream;
  tasks::set_traffic(work, results, results * kFloat);  // a quarter is read, four bytes each
  if (variant != Variant::cpu) work.read_issued = results * kFloat;
  if (variant == Variant::fpga) work.add_loop(results / 4, 1, 20);
  return work;
}

const KernelSpec& upsample_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("detection", "upsample");
    s.geometry = map_geometry;
    s.work = upsample_work;
    tasks::set_buffers(s.design, {{64 * 256 / 4, 128, 1, 2}});
    s.design.memory_ports = 2;
    return s;
  }();
  return spec;
}

/// Boxes from the network's numbers: a logistic (exponential and division) for all but the two
/// sizes, which take an exponential; the best class's score against the threshold; those above it
/// are appended to the list of candidates.
Work decode_work(Variant variant, const Shape& shape) {
  const std::uint64_t numbers =
      count(shape, "side") * count(shape, "side") * count(shape, "outputs");
  const std::uint64_t boxes = numbers / static_cast<std::uint64_t>(kBoxEntries);
  const std::uint64_t listed = static_cast<std::uint64_t>(kCandidates) / 3;
  Work work;
  work.kind = WorkKind::reduce;
  work[OpClass::float_special] = 2 * numbers - 2 * boxes;
  work[OpClass::float_add] = 2 * numbers;
  work[OpClass::float_mul] = 4 * boxes;
  if (variant == Variant::gpu) work[OpClass::atomic] = listed;
  tasks::set_traffic(work, numbers * kFloat, listed * kCandidateBytes);
  if (variant == Variant::fpga) work.add_loop(numbers, 1, 80);
  return work;
}

const KernelSpec& decode_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = tasks::outline_kernel("detection", "decode");
    s.geometry = map_geometry;
    s.work = decode_work;
    tasks::set_operators(
        s.design, {{OpClass::float_special, 2}, {OpClass::float_add, 2}, {OpClass::float_mul, 1}});
    s.design.memory_ports = 2;
    return s;
  }();
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

void add_layer(tasks::Program& program, const Layer& layer) {
  const Shape map{{"side", layer.side}, {"inputs", layer.inputs}, {"outputs", layer.outputs}};
  switch (layer.kind) {
    case LayerKind::convolution:
      program.launch(convolution_spec(), map.with("kernel", layer.kernel)
                                             .with("stride", layer.stride)
                                             .with("shortcut", layer.shortcut));
      break;
    case LayerKind::upsample:
      program.launch(upsample_spec(), map);
      break;
    case LayerKind::decode:
      program.launch(decode_spec(), map);
      break;
  }
}

}  // namespace

tasks::TaskExport outline(const tasks::Sensors& sensors) {
  tasks::Program program;
  program.write(static_cast<std::uint64_t>(sensors.width) *
                static_cast<std::uint64_t>(sensors.height));  // the left picture
  program.write(sizeof(std::uint32_t));                       // no candidates yet
  program.launch(letterbox_spec(), {{"width", sensors.width},
                                    {"height", sensors.height},
                                    {"side", kNetworkSide},
                                    {"outputs", 3}});
  for (const Layer& layer : yolov3_layers()) add_layer(program, layer);
  program.read(sizeof(std::uint32_t));  // how many candidates, then they themselves
  program.read(static_cast<std::uint64_t>(kCandidates) * kCandidateBytes);
  program.host(suppress_spec(), {{"candidates", kCandidates}});
  tasks::TaskExport task{.name = "detection", .outline = true};
  task.kernels = {&letterbox_spec(), &convolution_spec(), &upsample_spec(), &decode_spec()};
  task.frames = {program};
  task.outputs = {{"detections", kDetections * kCandidateBytes}};
  return task;
}

}  // namespace partita::detection
