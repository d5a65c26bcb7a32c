// Specs of the kernels that stream over whole images: pyramid_down, fast_score, gaussian_blur.
#include "host/tasks/frontend/cases.h"
#include "host/tasks/frontend/kernels.h"
#include "host/tasks/frontend/spec_tools.h"

namespace partita::frontend {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;

const std::vector<runtime::ArgSpec> kImageArgs{{"src", Access::in, ElementType::u8},
                                               {"dst", Access::out, ElementType::u8},
                                               {"width", Access::scalar, ElementType::i32},
                                               {"height", Access::scalar, ElementType::i32}};

/// A work-item per pixel of `size` in groups of 32 x 8, or a work-item per band of rows, or one.
LaunchGeometry image_geometry(Variant variant, Size size, int band) {
  switch (variant) {
    case Variant::gpu:
      return {{round_up(size.width, 32), round_up(size.height, 8), 1}, {32, 8, 1}};
    case Variant::cpu:
      return {{divide_up(size.height, band), 1, 1}, {1, 1, 1}};
    case Variant::fpga:
      return {};
  }
  return {};
}

/// Groups of 32 x 8 pixels.
std::uint64_t tiles(Size size) {
  return divide_up(size.width, 32) * divide_up(size.height, 8);
}

KernelCase image_case(const Shape& shape, std::uint32_t seed, Size out) {
  const Size size = size_of(shape);
  return {shape,
          {bytes_of(textured_image(size, seed)), HostArray(ElementType::u8, pixels(out)),
           scalar(size.width), scalar(size.height)}};
}

Work pyramid_work(Variant variant, const Shape& shape) {
  const Size size = size_of(shape);
  const Size out = level_size(size, 1);
  const std::uint64_t n = pixels(out);
  Work work;
  work.kind = WorkKind::stencil;
  work.read_unique = pixels(size);
  work.written_unique = work.written_issued = n;
  if (variant == Variant::cpu) {  // columns are blended once per source pixel, then rows
    const auto blended =
        static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(out.height);
    work[OpClass::int_mul] = 2 * blended + 2 * n;
    work[OpClass::int_add] = blended + 3 * n;
    work.read_issued = 2 * blended;
    return work;
  }
  work[OpClass::int_mul] = 6 * n;
  work[OpClass::int_add] = 8 * n;
  work.read_issued = variant == Variant::gpu ? 4 * n : pixels(size);
  if (variant == Variant::fpga) {
    // Six pixels per iteration; no dependence but the line buffer at one address.
    work.add_loop(static_cast<std::uint64_t>(size.height) * divide_up(size.width, 6), 1, 40);
  }
  return work;
}

KernelSpec make_pyramid() {
  KernelSpec spec;
  spec.name = spec.source = "pyramid_down";
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = kImageArgs;
  spec.geometry = [](Variant variant, const Shape& shape) {
    return image_geometry(variant, level_size(size_of(shape), 1), 16);
  };
  spec.work = pyramid_work;
  spec.design = design({{683, 48, 1, 2}}, {{OpClass::int_mul, 30}, {OpClass::int_add, 40}}, 18, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    return image_case(shape, seed, level_size(size_of(shape), 1));
  };
  spec.golden = [](KernelCase& c) {
    c.args[1] = bytes_of(golden::pyramid_down(image_of(c.args[0], size_of(c.shape))));
  };
  spec.small_shapes = {{{"width", 6}, {"height", 6}},
                       {{"width", 37}, {"height", 20}},
                       {{"width", 64}, {"height", 48}}};
  spec.shapes = {{{"width", 11}, {"height", 97}},
                 {{"width", 1226}, {"height", 370}},
                 {{"width", 4096}, {"height", 17}},
                 {{"width", 1280}, {"height", 720}}};
  return spec;
}

Work fast_work(Variant variant, const Shape& shape) {
  const Size size = size_of(shape);
  const std::uint64_t n = pixels(size);
  Work work;
  work.kind = WorkKind::stencil;
  // Per pixel 16 differences of either sign (max, subtract), twice 48 minima and maxima over arcs,
  // and the comparison with the threshold.
  work[OpClass::int_add] = 168 * n;
  work.read_unique = work.written_unique = work.written_issued = n;
  switch (variant) {
    case Variant::gpu:
      work.read_issued = tiles(size) * 38 * 14;
      work.local_bytes = tiles(size) * 38 * 14 + 17 * n;
      break;
    case Variant::cpu:
      work.read_issued = size.width < 7 || size.height < 7
                             ? 0
                             : static_cast<std::uint64_t>(size.height - 6) *
                                   static_cast<std::uint64_t>(size.width - 6) * 17;
      break;
    case Variant::fpga:
      work.read_issued = n;
      work.add_loop(6 * static_cast<std::uint64_t>(size.width + 8), 1, 2);  // clearing the lines
      // Four pixels per iteration, the pipeline holds the tree of minima.
      work.add_loop(static_cast<std::uint64_t>(size.height + 3) * divide_up(size.width + 3, 4), 1,
                    24);
      break;
  }
  return work;
}

KernelSpec make_fast() {
  KernelSpec spec;
  spec.name = spec.source = "fast_score";
  spec.gpu_local_bytes = 38 * 14;
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = kImageArgs;
  spec.args[1].name = "score";
  spec.args.push_back({"threshold", Access::scalar, ElementType::i32});
  spec.geometry = [](Variant variant, const Shape& shape) {
    return image_geometry(variant, size_of(shape), 16);
  };
  spec.work = fast_work;
  spec.design = design({{1026, 32, 6, 2}}, {{OpClass::int_add, 672}}, 9, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    KernelCase c = image_case(shape, seed, size_of(shape));
    c.args.push_back(scalar(seed % 2 == 0 ? 7 : 20));
    return c;
  };
  spec.golden = [](KernelCase& c) {
    const GrayImage image = image_of(c.args[0], size_of(c.shape));
    c.args[1] = bytes_of(golden::fast_score(image, c.args[4].as<std::int32_t>()[0]));
  };
  spec.small_shapes = {{{"width", 5}, {"height", 9}},
                       {{"width", 7}, {"height", 7}},
                       {{"width", 37}, {"height", 19}},
                       {{"width", 70}, {"height", 24}}};
  spec.shapes = {{{"width", 22}, {"height", 23}},
                 {{"width", 4096}, {"height", 9}},
                 {{"width", 1021}, {"height", 308}},
                 {{"width", 1280}, {"height", 720}}};
  return spec;
}

Work blur_work(Variant variant, const Shape& shape) {
  const Size size = size_of(shape);
  const std::uint64_t n = pixels(size);
  Work work;
  work.kind = WorkKind::stencil;
  // A tap is four multiplications and eight additions; two per pixel, on the GPU the halo's
  // besides.
  const std::uint64_t taps = variant == Variant::gpu ? n + tiles(size) * 38 * 8 : 2 * n;
  work[OpClass::int_mul] = 4 * taps;
  work[OpClass::int_add] = 8 * taps;
  work.read_unique = work.written_unique = work.written_issued = n;
  switch (variant) {
    case Variant::gpu:
      work.read_issued = tiles(size) * 38 * 14;
      work.local_bytes = tiles(size) * (38 * 14 + 38 * 8) + 7 * taps;
      break;
    case Variant::cpu:
      work.read_issued = 7 * n;
      break;
    case Variant::fpga:
      work.read_issued = n;
      work.add_loop(6 * static_cast<std::uint64_t>(size.width + 8), 1, 2);
      work.add_loop(static_cast<std::uint64_t>(size.height + 3) * divide_up(size.width + 3, 4), 1,
                    24);
      break;
  }
  return work;
}

KernelSpec make_blur() {
  KernelSpec spec;
  spec.name = spec.source = "gaussian_blur";
  spec.gpu_local_bytes = 38 * 14 + 38 * 8;
  spec.task = "frontend";
  spec.variants = kAllVariants;
  spec.args = kImageArgs;
  spec.geometry = [](Variant variant, const Shape& shape) {
    return image_geometry(variant, size_of(shape), 32);
  };
  spec.work = blur_work;
  spec.design = design({{1026, 32, 6, 2}}, {{OpClass::int_mul, 32}, {OpClass::int_add, 64}}, 16, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    return image_case(shape, seed, size_of(shape));
  };
  spec.golden = [](KernelCase& c) {
    c.args[1] = bytes_of(golden::gaussian_blur(image_of(c.args[0], size_of(c.shape))));
  };
  spec.small_shapes = {{{"width", 1}, {"height", 1}},
                       {{"width", 5}, {"height", 3}},
                       {{"width", 37}, {"height", 19}},
                       {{"width", 64}, {"height", 24}}};
  spec.shapes = {{{"width", 17}, {"height", 65}},
                 {{"width", 4096}, {"height", 9}},
                 {{"width", 1021}, {"height", 308}},
                 {{"width", 1280}, {"height", 720}}};
  return spec;
}

}  // namespace

const KernelSpec& pyramid_down_spec() {
  static const KernelSpec spec = make_pyramid();
  return spec;
}

const KernelSpec& fast_score_spec() {
  static const KernelSpec spec = make_fast();
  return spec;
}

const KernelSpec& gaussian_blur_spec() {
  static const KernelSpec spec = make_blur();
  return spec;
}

}  // namespace partita::frontend
