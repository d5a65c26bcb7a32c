// Specs of convolution and depthwise, and the task's list.
#include <algorithm>

#include "host/tasks/detection/golden.h"
#include "host/tasks/detection/kernels.h"
#include "host/tasks/detection/spec_helpers.h"

namespace partita::detection {
namespace {

using io::darknet::Activation;
using runtime::Access;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;

constexpr std::uint64_t kGpuPixels = 64, kGpuItems = 64, kTilesToFill = 120;
constexpr std::uint64_t kFpgaPixels = 13, kFpgaChannels = 32, kFpgaTiles = 10, kFpgaChunk = 128;

// ---- convolution --------------------------------------------------------------------------------

struct Sizes {
  explicit Sizes(const Shape& s)
      : width(u64(s["width"])),
        pixels(u64(s["width"] * s["height"])),
        outputs(u64(s["outputs"])),
        lanes(u64(s["lanes"])),
        blocks(ceil_div(outputs, lanes)),
        inputs(u64(s["inputs"])),
        chain(u64(s["size"] * s["size"]) * inputs) {}

  /// Pixels of a CPU tile: as kernels/detection/convolution.cpu.cl chooses.
  std::uint64_t cpu_tile() const {
    const auto cost = [this](std::uint64_t tile) {
      return width < tile ? ~std::uint64_t{0} : ceil_div(width, tile) * (2 * tile + 3);
    };
    std::uint64_t best = 1;
    for (const std::uint64_t tile : {4, 10, 13}) {
      if (cost(tile) < cost(best)) best = tile;
    }
    return best;
  }
  std::uint64_t gpu_tile_channels() const {
    const std::uint64_t large = ceil_div(pixels, kGpuPixels) * ceil_div(outputs, 64);
    if (outputs > 32 && large >= kTilesToFill) return 64;
    return outputs > 16 ? 32 : outputs > 8 ? 16 : 8;
  }
  std::uint64_t gpu_tiles() const {
    return ceil_div(pixels, kGpuPixels) * ceil_div(outputs, gpu_tile_channels());
  }
  std::uint64_t fpga_tiles() const { return ceil_div(width, kFpgaPixels) * (pixels / width); }

  std::uint64_t width, pixels, outputs, lanes, blocks, inputs, chain;
};

Work convolution_work(Variant variant, const Shape& shape) {
  const Sizes s(shape);
  const std::uint64_t results = s.pixels * s.outputs;
  const std::uint64_t residual = shape["residual"] != 0 ? results : 0;
  Work work;
  work.kind = WorkKind::dense;
  const std::uint64_t stride = u64(shape["stride"]);
  const std::uint64_t window = std::min(u64(shape["size"]), stride);
  work.read_unique =
      (s.pixels * window * window * s.inputs + (s.chain + 1) * s.outputs + residual) * kFloat;
  work.written_unique = (results + border_numbers(shape, s.outputs)) * kFloat;
  work.written_issued = work.written_unique;
  std::uint64_t computed = results;
  if (variant == Variant::cpu) {
    // Each tile asks for its pixels, all weights of its block and the bias.
    const std::uint64_t tile = s.cpu_tile();
    const std::uint64_t row_tiles = ceil_div(s.width, tile), tiles = s.pixels / s.width * row_tiles;
    computed = tiles * tile * s.outputs;
    work.read_issued = tiles * s.blocks * (s.chain * (tile + s.lanes) + s.lanes) * kFloat;
    if (residual > 0) work.read_issued += computed * kFloat;
    work.written_issued += (computed - results) * kFloat;
    work[OpClass::float_fma] = computed * s.chain;
  } else if (variant == Variant::gpu) {
    // Tiles are whole: what sticks out is computed as well.
    const std::uint64_t channels = s.gpu_tile_channels(), steps = s.gpu_tiles() * s.chain;
    work[OpClass::float_fma] = steps * kGpuPixels * channels;
    work.read_issued =
        (steps * (kGpuPixels + channels) + s.gpu_tiles() * 8 * channels + residual) * kFloat;
    work.local_bytes =
        steps * (kGpuPixels + channels + kGpuItems * (kGpuPixels + channels) / 8) * kFloat;
  } else {
    const std::uint64_t tiles = s.fpga_tiles(), groups = ceil_div(tiles, kFpgaTiles);
    work[OpClass::float_fma] = tiles * s.blocks * kFpgaPixels * kFpgaChannels * s.chain;
    work.read_issued = (s.blocks * tiles * kFpgaPixels * (s.chain + s.lanes) +
                        groups * s.blocks * s.chain * s.lanes + residual) *
                       kFloat;
    // A step of the chain for one tile per clock; a group's last step leaves the units 60 cycles
    // later. A group of fewer than ten tiles waits for its own sums all the same. Pixels and
    // weights of the next chunk come in meanwhile, through four ports of 16 bytes: 130 pixels and
    // 32 weights a step of ten cycles.
    const std::uint64_t chunks = groups * s.blocks * ceil_div(s.chain, kFpgaChunk);
    work.add_loop(groups * s.blocks * s.chain * kFpgaTiles, 1,
                  static_cast<std::uint32_t>(std::min<std::uint64_t>(chunks * 60, 1U << 30)));
    add_result_loops(work, s.pixels * s.blocks * s.lanes, shape);
  }
  add_activation(work, computed, shape);
  if (residual > 0) work[OpClass::float_add] += computed;
  return work;
}

LaunchGeometry convolution_geometry(Variant variant, const Shape& shape) {
  const Sizes s(shape);
  if (variant == Variant::fpga) return {};
  if (variant == Variant::cpu) return {{s.pixels / s.width * s.blocks, 1, 1}, {1, 1, 1}};
  return {{s.gpu_tiles() * kGpuItems, 1, 1}, {kGpuItems, 1, 1}};
}

/// Maps of a case: that of the result and the residual's; the input's is the windows' extent.
struct CaseMaps {
  explicit CaseMaps(const Shape& s, int inputs, int outputs) {
    const int other = s.has("slice") && s["slice"] != 0 ? kOtherChannels : 0;
    const int stride = entry(s, "stride"), size = entry(s, "size");
    in = {(entry(s, "width") - 1) * stride + size, (entry(s, "height") - 1) * stride + size,
          inputs + other, 0};
    out = {entry(s, "width"), entry(s, "height"), outputs + other, entry(s, "border")};
    residual = {out.width, out.height, outputs + other, 0};
    first = other > 0 ? kFirstChannel : 0;
  }
  TensorLayout in, out, residual;
  int first = 0;
};

void add_maps(CaseArgs& args, const CaseMaps& maps, bool residual) {
  args.view(maps.in.view(maps.first));
  args.view(residual ? maps.residual.view(maps.first) : TensorView{});
  args.view(maps.out.view(maps.first));
}

void add_activation_args(CaseArgs& args, const Shape& shape) {
  const ActivationCode code = activation_of(shape);
  args.real(code.slope);
  args.integer(code.code);
}

KernelCase convolution_case(const Shape& shape, std::uint32_t seed) {
  const CaseMaps maps(shape, entry(shape, "inputs"), entry(shape, "outputs"));
  const Sizes s(shape);
  CaseArgs args(seed);
  args.numbers(maps.in.count());
  args.numbers(s.blocks * s.lanes * s.chain);
  args.numbers(s.blocks * s.lanes);
  args.numbers(maps.residual.count());
  args.numbers(maps.out.count());
  add_maps(args, maps, shape["residual"] != 0);
  for (const char* name :
       {"width", "height", "inputs", "outputs", "size", "stride", "lanes", "border"}) {
    args.integer(shape[name]);
  }
  add_activation_args(args, shape);
  return {shape, args.take()};
}

ConvolutionSize size_of(const Shape& s, int inputs, int outputs) {
  return {entry(s, "width"),  entry(s, "height"), inputs, outputs, entry(s, "size"),
          entry(s, "stride"), entry(s, "border")};
}

struct GoldenMaps {
  GoldenMaps(KernelCase& c, const CaseMaps& maps)
      : in{c.args[0].as<float>(), maps.in.view(maps.first)},
        residual{c.args[3].as<float>(),
                 c.shape["residual"] != 0 ? maps.residual.view(maps.first) : TensorView{}},
        out{c.args[4].as<float>(), maps.out.view(maps.first)} {}
  Source in, residual;
  Target out;
};

void convolution_golden(KernelCase& c) {
  const int inputs = entry(c.shape, "inputs"), outputs = entry(c.shape, "outputs");
  const GoldenMaps maps(c, CaseMaps(c.shape, inputs, outputs));
  golden_convolution(size_of(c.shape, inputs, outputs), entry(c.shape, "lanes"), maps.in,
                     c.args[1].as<float>(), c.args[2].as<float>(), maps.residual,
                     activation_of(c.shape), maps.out);
}

Shape convolution_shape(int width, int height, int inputs, int outputs, int size, int stride,
                        int border, bool residual, Activation activation, bool slice) {
  return {{"width", width},
          {"height", height},
          {"inputs", inputs},
          {"outputs", outputs},
          {"size", size},
          {"stride", stride},
          {"lanes", lanes_for(outputs)},
          {"border", border},
          {"residual", residual},
          {"activation", static_cast<int>(activation)},
          {"slice", slice}};
}

void add_buffer_args(KernelSpec& spec) {
  spec.args = {floats("in", Access::in), floats("weights", Access::in), floats("bias", Access::in),
               floats("residual", Access::in), floats("out", Access::out)};
  for (const char* view : {"in", "residual", "out"}) add_view(spec, view);
}

void add_activation_spec(KernelSpec& spec) {
  spec.args.push_back(floats("slope", Access::scalar));
  add_integers(spec, {"activation"});
}

KernelSpec make_convolution() {
  KernelSpec spec = detection_spec("convolution", "convolution");
  add_buffer_args(spec);
  add_integers(spec, {"width", "height", "inputs", "outputs", "size", "stride", "lanes", "border"});
  add_activation_spec(spec);
  spec.geometry = convolution_geometry;
  spec.work = convolution_work;
  spec.gpu_local_bytes = 2 * 8 * 64 * kFloat;
  // Pixels of ten tiles and weights, one chunk in use and one coming in; sums of ten tiles.
  spec.design.buffers[0] = {2 * kFpgaTiles * kFpgaChunk, 32, kFpgaPixels, 2};
  spec.design.buffers[1] = {2 * kFpgaChunk, 32, kFpgaChannels, 2};
  spec.design.buffers[2] = {kFpgaTiles, 32, kFpgaPixels * kFpgaChannels, 2};
  spec.design.buffer_count = 3;
  spec.design.operators[static_cast<std::size_t>(OpClass::float_fma)] = kFpgaPixels * kFpgaChannels;
  add_result_operators(spec.design);
  spec.design.memory_ports = 4;
  spec.make_case = convolution_case;
  spec.golden = convolution_golden;
  const auto shape = convolution_shape;
  spec.small_shapes = {shape(13, 2, 4, 8, 3, 1, 1, false, Activation::leaky, false),
                       shape(5, 3, 9, 20, 1, 1, 0, true, Activation::linear, true),
                       shape(4, 2, 3, 40, 3, 2, 0, false, Activation::mish, false)};
  spec.shapes = {shape(1, 1, 1, 1, 1, 1, 0, false, Activation::linear, false),
                 shape(3, 2, 130, 17, 3, 1, 2, true, Activation::relu, true),
                 shape(26, 7, 3, 32, 3, 1, 1, false, Activation::leaky, false),
                 shape(11, 9, 16, 33, 5, 2, 1, false, Activation::relu6, true),
                 shape(20, 5, 24, 255, 1, 1, 0, false, Activation::logistic, false),
                 shape(41, 6, 12, 16, 3, 1, 0, false, Activation::swish, false),
                 shape(104, 80, 8, 64, 3, 1, 1, true, Activation::leaky, false),
                 shape(13, 13, 256, 128, 3, 1, 1, true, Activation::leaky, false)};
  return spec;
}

// ---- depthwise ----------------------------------------------------------------------------------

Work depthwise_work(Variant variant, const Shape& shape) {
  const std::uint64_t channels = u64(shape["channels"]), results = numbers_of(shape, "channels");
  const std::uint64_t taps = u64(shape["size"] * shape["size"]), stride = u64(shape["stride"]);
  const std::uint64_t residual = shape["residual"] != 0 ? results : 0;
  const std::uint64_t window = std::min(u64(shape["size"]), stride);
  Work work;
  work.kind = WorkKind::stencil;
  work[OpClass::float_fma] = results * taps;
  work.read_unique = (results * window * window + (taps + 1) * channels + residual) * kFloat;
  work.written_unique = work.written_issued = (results + border_numbers(shape, channels)) * kFloat;
  if (variant == Variant::gpu) {
    work.read_issued = (results * (2 * taps + 1) + residual) * kFloat;
  } else if (variant == Variant::cpu) {
    const std::uint64_t rows = u64(shape["height"]);
    work.read_issued = (results * taps + rows * channels * (taps + 1) + residual) * kFloat;
    const bool plain = shape["size"] != 3 && shape["size"] != 5;
    if (plain || is_curve(shape)) {
      work.read_issued = (results * (2 * taps + 1) + residual) * kFloat;
    }
  } else {
    work.read_issued = (results * taps + channels * (taps + 1) + residual) * kFloat;
    // Eight channels of a tap per clock; sums are due again after eight. Then the results.
    const std::uint64_t pixels = u64(shape["width"] * shape["height"]);
    work.add_loop(pixels * taps * ceil_div(channels, 8), 1, 60);
    add_result_loops(work, results, shape);
  }
  add_activation(work, results, shape);
  work[OpClass::float_add] += residual;
  return work;
}

KernelCase depthwise_case(const Shape& shape, std::uint32_t seed) {
  const int channels = entry(shape, "channels");
  const CaseMaps maps(shape, channels, channels);
  CaseArgs args(seed);
  args.numbers(maps.in.count());
  args.numbers(static_cast<std::size_t>(shape["size"] * shape["size"] * channels));
  args.numbers(static_cast<std::size_t>(channels));
  args.numbers(maps.residual.count());
  args.numbers(maps.out.count());
  add_maps(args, maps, shape["residual"] != 0);
  for (const char* name : {"width", "height", "channels", "size", "stride", "border"}) {
    args.integer(shape[name]);
  }
  add_activation_args(args, shape);
  return {shape, args.take()};
}

void depthwise_golden(KernelCase& c) {
  const int channels = entry(c.shape, "channels");
  const GoldenMaps maps(c, CaseMaps(c.shape, channels, channels));
  golden_depthwise(size_of(c.shape, channels, channels), maps.in, c.args[1].as<float>(),
                   c.args[2].as<float>(), maps.residual, activation_of(c.shape), maps.out);
}

Shape depthwise_shape(int width, int height, int channels, int size, int stride, int border,
                      bool residual, Activation activation, bool slice) {
  return {{"width", width},       {"height", height},
          {"channels", channels}, {"size", size},
          {"stride", stride},     {"border", border},
          {"residual", residual}, {"activation", static_cast<int>(activation)},
          {"slice", slice}};
}

KernelSpec make_depthwise() {
  KernelSpec spec = detection_spec("depthwise", "depthwise");
  add_buffer_args(spec);
  add_integers(spec, {"width", "height", "channels", "size", "stride", "border"});
  add_activation_spec(spec);
  spec.geometry = [](Variant variant, const Shape& shape) {
    return map_geometry(variant, u64(shape["height"]), numbers_of(shape, "channels"));
  };
  spec.work = depthwise_work;
  spec.design.buffers[0] = {121 * 64 / 8, 32, 8, 2};
  spec.design.buffers[1] = {8, 32, 16, 2};
  spec.design.buffer_count = 2;
  spec.design.operators[static_cast<std::size_t>(OpClass::float_fma)] = 8;
  add_result_operators(spec.design);
  spec.design.memory_ports = 2;
  spec.make_case = depthwise_case;
  spec.golden = depthwise_golden;
  const auto shape = depthwise_shape;
  spec.small_shapes = {shape(6, 3, 16, 3, 1, 1, false, Activation::leaky, false),
                       shape(3, 2, 27, 5, 2, 0, true, Activation::linear, true)};
  spec.shapes = {shape(1, 1, 1, 1, 1, 0, false, Activation::linear, false),
                 shape(9, 5, 33, 7, 1, 1, false, Activation::relu, false),
                 shape(10, 10, 70, 3, 2, 2, true, Activation::swish, true),
                 shape(40, 30, 136, 5, 1, 1, false, Activation::leaky, false),
                 shape(80, 80, 48, 3, 2, 0, false, Activation::leaky, false)};
  return spec;
}

}  // namespace

const KernelSpec& convolution_spec() {
  static const KernelSpec spec = make_convolution();
  return spec;
}

const KernelSpec& depthwise_spec() {
  static const KernelSpec spec = make_depthwise();
  return spec;
}

std::vector<const KernelSpec*> kernel_specs() {
  return {&convolution_spec(), &depthwise_spec(), &maxpool_spec(), &upsample_spec(), &add_spec()};
}

int lanes_for(int outputs) {
  const auto padded = [outputs](int lanes) { return (outputs + lanes - 1) / lanes * lanes; };
  // Wider blocks read each pixel less often: worth a fifth of lanes in vain.
  int best = 8;
  for (const int lanes : {16, 32}) {
    if (padded(lanes) * 5 <= padded(8) * 6) best = lanes;
  }
  return best;
}

}  // namespace partita::detection
