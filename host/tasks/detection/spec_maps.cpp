// Specs of maxpool, upsample and add.
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

LaunchGeometry geometry_of_map(Variant variant, const Shape& shape) {
  return map_geometry(variant, u64(shape["height"]), numbers_of(shape, "channels"));
}

Work map_work(const Shape& shape, WorkKind kind) {
  Work work;
  work.kind = kind;
  work.written_issued = work.written_unique =
      (numbers_of(shape, "channels") + border_numbers(shape, u64(shape["channels"]))) * kFloat;
  return work;
}

/// A map of the case, with channels of others around its own.
TensorLayout case_map(int width, int height, int channels, int border) {
  return {width, height, channels + kOtherChannels, border};
}

TensorLayout result_map(const Shape& s) {
  return case_map(entry(s, "width"), entry(s, "height"), entry(s, "channels"), entry(s, "border"));
}

// ---- maxpool ------------------------------------------------------------------------------------

/// Pixels that all windows along one side cover inside the map.
std::uint64_t covered(int count, int in, int size, int stride, int before) {
  std::uint64_t sum = 0;
  for (int i = 0; i < count; ++i) {
    const int first = std::max(i * stride - before, 0);
    sum += u64(std::max(std::min(i * stride - before + size, in) - first, 0));
  }
  return sum;
}

Work maxpool_work(Variant variant, const Shape& s) {
  const int size = entry(s, "size"), stride = entry(s, "stride"), before = entry(s, "before");
  const std::uint64_t taps =
      covered(entry(s, "width"), entry(s, "in_width"), size, stride, before) *
      covered(entry(s, "height"), entry(s, "in_height"), size, stride, before) * u64(s["channels"]);
  Work work = map_work(s, WorkKind::stencil);
  work[OpClass::float_add] = taps;
  work.read_issued = taps * kFloat;
  work.read_unique = u64(s["in_width"] * s["in_height"] * s["channels"]) * kFloat;
  if (variant == Variant::fpga) {
    work.add_loop(taps, 1, 20);
    work.add_loop(numbers_of(s, "channels"), 2, 20);
  }
  return work;
}

TensorLayout pool_input(const Shape& s) {
  return case_map(entry(s, "in_width"), entry(s, "in_height"), entry(s, "channels"), 1);
}

KernelSpec make_maxpool() {
  KernelSpec spec = detection_spec("maxpool", "maps");
  spec.args = {floats("in", Access::in), floats("out", Access::out)};
  for (const char* view : {"in", "out"}) add_view(spec, view);
  static constexpr const char* kSizes[] = {"in_width", "in_height", "width",  "height", "channels",
                                           "size",     "stride",    "before", "border"};
  for (const char* name : kSizes) add_integers(spec, {name});
  spec.geometry = geometry_of_map;
  spec.work = maxpool_work;
  spec.design.buffers[0] = {64, 32, 1, 2};
  spec.design.buffer_count = 1;
  spec.design.operators[static_cast<std::size_t>(OpClass::float_add)] = 1;
  spec.design.memory_ports = 2;
  spec.make_case = [](const Shape& s, std::uint32_t seed) -> KernelCase {
    CaseArgs args(seed);
    args.numbers(pool_input(s).count());
    args.numbers(result_map(s).count());
    args.view(pool_input(s).view(kFirstChannel));
    args.view(result_map(s).view(kFirstChannel));
    for (const char* name : kSizes) args.integer(s[name]);
    return {s, args.take()};
  };
  spec.golden = [](KernelCase& c) {
    const Shape& s = c.shape;
    const PoolSize size{entry(s, "in_width"), entry(s, "in_height"), entry(s, "width"),
                        entry(s, "height"),   entry(s, "channels"),  entry(s, "size"),
                        entry(s, "stride"),   entry(s, "before"),    entry(s, "border")};
    golden_maxpool(size, {c.args[0].as<float>(), pool_input(s).view(kFirstChannel)},
                   {c.args[1].as<float>(), result_map(s).view(kFirstChannel)});
  };
  const auto shape = [](int in_width, int in_height, int channels, int size, int stride,
                        int border) -> Shape {
    return {{"in_width", in_width},
            {"in_height", in_height},
            {"width", (in_width - 1) / stride + 1},
            {"height", (in_height - 1) / stride + 1},
            {"channels", channels},
            {"size", size},
            {"stride", stride},
            {"before", (size - 1) / 2},
            {"border", border}};
  };
  spec.small_shapes = {shape(6, 4, 18, 2, 2, 1), shape(5, 3, 3, 3, 1, 0)};
  spec.shapes = {shape(1, 1, 1, 2, 1, 0), shape(13, 13, 64, 2, 1, 1), shape(10, 10, 96, 9, 1, 0),
                 shape(52, 26, 40, 2, 2, 1)};
  return spec;
}

// ---- upsample -----------------------------------------------------------------------------------

TensorLayout upsample_input(const Shape& s) {
  const int stride = entry(s, "stride");
  return case_map((entry(s, "width") + stride - 1) / stride,
                  (entry(s, "height") + stride - 1) / stride, entry(s, "channels"), 0);
}

KernelSpec make_upsample() {
  KernelSpec spec = detection_spec("upsample_map", "maps");
  spec.args = {floats("in", Access::in), floats("out", Access::out)};
  for (const char* view : {"in", "out"}) add_view(spec, view);
  add_integers(spec, {"width", "height", "channels", "stride", "border"});
  spec.geometry = geometry_of_map;
  spec.work = [](Variant variant, const Shape& s) {
    const std::uint64_t numbers = numbers_of(s, "channels");
    Work work = map_work(s, WorkKind::stream);
    work.read_issued = numbers * kFloat;
    work.read_unique = numbers / u64(s["stride"] * s["stride"]) * kFloat;
    if (variant == Variant::fpga) work.add_loop(numbers, 1, 20);
    return work;
  };
  spec.design.memory_ports = 2;
  spec.make_case = [](const Shape& s, std::uint32_t seed) -> KernelCase {
    CaseArgs args(seed);
    args.numbers(upsample_input(s).count());
    args.numbers(result_map(s).count());
    args.view(upsample_input(s).view(kFirstChannel));
    args.view(result_map(s).view(kFirstChannel));
    for (const char* name : {"width", "height", "channels", "stride", "border"}) {
      args.integer(s[name]);
    }
    return {s, args.take()};
  };
  spec.golden = [](KernelCase& c) {
    const Shape& s = c.shape;
    golden_upsample(entry(s, "width"), entry(s, "height"), entry(s, "channels"), entry(s, "stride"),
                    entry(s, "border"),
                    {c.args[0].as<float>(), upsample_input(s).view(kFirstChannel)},
                    {c.args[1].as<float>(), result_map(s).view(kFirstChannel)});
  };
  const auto shape = [](int width, int height, int channels, int stride, int border) -> Shape {
    return {{"width", width},
            {"height", height},
            {"channels", channels},
            {"stride", stride},
            {"border", border}};
  };
  spec.small_shapes = {shape(6, 4, 18, 2, 1), shape(5, 3, 3, 1, 0)};
  spec.shapes = {shape(1, 1, 1, 1, 0), shape(9, 6, 64, 3, 2), shape(52, 52, 128, 2, 0)};
  return spec;
}

// ---- add ----------------------------------------------------------------------------------------

KernelSpec make_add() {
  KernelSpec spec = detection_spec("add_maps", "maps");
  spec.args = {floats("a", Access::in), floats("b", Access::in), floats("out", Access::out)};
  for (const char* view : {"a", "b", "out"}) add_view(spec, view);
  add_integers(spec, {"width", "height", "channels", "border"});
  spec.args.push_back(floats("slope", Access::scalar));
  add_integers(spec, {"activation"});
  spec.geometry = geometry_of_map;
  spec.work = [](Variant variant, const Shape& s) {
    const std::uint64_t numbers = numbers_of(s, "channels");
    Work work = map_work(s, WorkKind::stream);
    work[OpClass::float_add] = numbers;
    add_activation(work, numbers, s);
    work.read_issued = work.read_unique = 2 * numbers * kFloat;
    if (variant == Variant::fpga) work.add_loop(numbers, is_curve(s) ? 6 : 1, 100);
    return work;
  };
  add_result_operators(spec.design);
  spec.design.memory_ports = 3;
  const auto input = [](const Shape& s, int border) {
    return case_map(entry(s, "width"), entry(s, "height"), entry(s, "channels"), border);
  };
  spec.make_case = [input](const Shape& s, std::uint32_t seed) -> KernelCase {
    CaseArgs args(seed);
    for (const TensorLayout& map : {input(s, 0), input(s, 1), result_map(s)}) {
      args.numbers(map.count());
    }
    for (const TensorLayout& map : {input(s, 0), input(s, 1), result_map(s)}) {
      args.view(map.view(kFirstChannel));
    }
    for (const char* name : {"width", "height", "channels", "border"}) args.integer(s[name]);
    args.real(activation_of(s).slope);
    args.integer(activation_of(s).code);
    return {s, args.take()};
  };
  spec.golden = [input](KernelCase& c) {
    const Shape& s = c.shape;
    golden_add(entry(s, "width"), entry(s, "height"), entry(s, "channels"), entry(s, "border"),
               {c.args[0].as<float>(), input(s, 0).view(kFirstChannel)},
               {c.args[1].as<float>(), input(s, 1).view(kFirstChannel)}, activation_of(s),
               {c.args[2].as<float>(), result_map(s).view(kFirstChannel)});
  };
  const auto shape = [](int width, int height, int channels, int border,
                        Activation activation) -> Shape {
    return {{"width", width},
            {"height", height},
            {"channels", channels},
            {"border", border},
            {"activation", static_cast<int>(activation)}};
  };
  spec.small_shapes = {shape(6, 4, 18, 1, Activation::leaky), shape(5, 3, 3, 0, Activation::mish)};
  spec.shapes = {shape(1, 1, 1, 0, Activation::linear), shape(9, 6, 64, 2, Activation::logistic),
                 shape(26, 26, 40, 1, Activation::linear)};
  return spec;
}

}  // namespace

const KernelSpec& maxpool_spec() {
  static const KernelSpec spec = make_maxpool();
  return spec;
}

const KernelSpec& upsample_spec() {
  static const KernelSpec spec = make_upsample();
  return spec;
}

const KernelSpec& add_spec() {
  static const KernelSpec spec = make_add();
  return spec;
}

}  // namespace partita::detection
