// Specs of resample, cell_histograms and cell_features: from the picture to a patch's features.
#include <algorithm>

#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/spec_helpers.h"
#include "host/tasks/tracking/tables.h"

namespace partita::tracking {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;

constexpr std::uint64_t kBand = 8;        ///< rows of a patch that a CPU work-item resamples
constexpr std::uint64_t kRootOps = 13;    ///< reciprocal_root: float operations
constexpr std::uint64_t kEnergyOps = 36;  ///< of a cell: nine sums of two bins, squared and added

std::uint64_t side_of(const Shape& shape) {
  return kCell * count_of(shape, "cells");
}

LaunchGeometry resample_geometry(Variant variant, const Shape& shape) {
  const std::uint64_t patches = count_of(shape, "patches");
  switch (variant) {
    case Variant::cpu:
      return items(side_of(shape) / kBand, patches);
    case Variant::gpu:
      return {{side_of(shape), side_of(shape), patches}, {16, 16, 1}};
    case Variant::fpga:
      break;
  }
  return {};
}

Work resample_work(Variant variant, const Shape& shape) {
  const std::uint64_t patches = count_of(shape, "patches");
  const std::uint64_t samples = count_of(shape, "samples");
  const std::uint64_t pixels = patches * side_of(shape) * side_of(shape);
  const std::uint64_t windows = patches * kWindowEntries * 4;
  Work work;
  work.kind = WorkKind::gather;
  // Per sample: a place and its fractions, four clamps, three mixtures; per pixel the mean.
  work[OpClass::int_add] = samples * 18 + pixels * 2;
  work[OpClass::int_mul] = samples * 6;
  work.read_unique =
      std::min(samples, count_of(shape, "width") * count_of(shape, "height")) + windows;
  work.written_unique = work.written_issued = pixels * 2;
  switch (variant) {
    case Variant::cpu:
      work.read_issued = samples * 4 + windows * side_of(shape) / kBand;
      break;
    case Variant::gpu:
      work.read_issued = samples * 4 + pixels * kWindowEntries * 4;
      break;
    case Variant::fpga:
      // Four bytes of a sample come through one port: a sample every four clocks.
      work.read_issued = samples * 4 + windows;
      work.add_loop(samples, 4, static_cast<std::uint32_t>(patches * 40));
      break;
  }
  return work;
}

/// Windows of all kinds: inside, across the edges, wholly outside, enlarged and reduced.
KernelCase resample_case(const Shape& shape, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto width = static_cast<int>(shape["width"]);
  const auto height = static_cast<int>(shape["height"]);
  const auto side = static_cast<int>(side_of(shape));
  HostArray image(ElementType::u8, static_cast<std::size_t>(width * height));
  for (std::uint8_t& value : image.as<std::uint8_t>()) value = static_cast<std::uint8_t>(random());
  const std::size_t patches = count_of(shape, "patches");
  HostArray windows(ElementType::i32, patches * kWindowEntries);
  std::int64_t samples = 0;
  const bool several = shape.has("taps") && shape["taps"] > 1;
  for (std::size_t p = 0; p < patches; ++p) {
    std::int32_t* window = &windows.as<std::int32_t>()[p * kWindowEntries];
    const auto within = [&random](int range) {
      return static_cast<std::int32_t>(random() % static_cast<unsigned>(range));
    };
    window[0] = within(width * 65536) - width * 16384;
    window[1] = within(height * 65536) - height * 16384;
    window[4] = several ? static_cast<std::int32_t>(p % 4) : 0;
    window[2] = 8000 + within(60000 << window[4]);
    window[3] = 8000 + within(60000 << window[4]);
    samples += static_cast<std::int64_t>(side * side) << (2 * window[4]);
  }
  return {
      shape.with("samples", samples),
      {image, windows, HostArray(ElementType::u16, patches * static_cast<std::size_t>(side * side)),
       number(width), number(height), number(side), number(shape["patches"])}};
}

KernelSpec make_resample() {
  KernelSpec spec = tracking_spec("resample");
  spec.args = {{"image", Access::in, ElementType::u8},
               {"windows", Access::in, ElementType::i32},
               {"patches", Access::out, ElementType::u16},
               integer("width"),
               integer("height"),
               integer("side"),
               integer("count")};
  spec.geometry = resample_geometry;
  spec.work = resample_work;
  spec.design = design({}, {{OpClass::int_add, 20}, {OpClass::int_mul, 10}}, 24, 2);
  spec.make_case = resample_case;
  spec.golden = [](KernelCase& c) {
    golden_resample({static_cast<int>(c.shape["width"]), static_cast<int>(c.shape["height"])},
                    c.args[0].as<std::uint8_t>(), c.args[1].as<std::int32_t>(),
                    static_cast<int>(side_of(c.shape)), c.args[2].as<std::uint16_t>());
  };
  spec.small_shapes = {{{"width", 90}, {"height", 50}, {"cells", 16}, {"patches", 1}}};
  spec.shapes = {{{"width", 1}, {"height", 1}, {"cells", 16}, {"patches", 2}},
                 {{"width", 333}, {"height", 75}, {"cells", 16}, {"patches", 7}, {"taps", 8}},
                 {{"width", 1280}, {"height", 720}, {"cells", 32}, {"patches", 9}, {"taps", 8}}};
  return spec;
}

/// Groups of 8 x 8 cells on the GPU, rows of cells on the CPU.
LaunchGeometry cell_geometry(Variant variant, const Shape& shape) {
  const std::uint64_t cells = count_of(shape, "cells");
  const std::uint64_t patches = count_of(shape, "patches");
  switch (variant) {
    case Variant::cpu:
      return items(cells, patches);
    case Variant::gpu:
      return {{cells, cells, patches}, {kTile, kTile, 1}};
    case Variant::fpga:
      break;
  }
  return {};
}

Work histograms_work(Variant variant, const Shape& shape) {
  const std::uint64_t cells = count_of(shape, "cells");
  const std::uint64_t patches = count_of(shape, "patches");
  const std::uint64_t side = side_of(shape);
  const std::uint64_t plane = plane_of(shape);
  // Pixels whose votes are found: on the GPU those at a group's edge twice, on the CPU all but four
  // rows twice, on the FPGA once for every cell that they count for.
  std::uint64_t votes = 0;
  const std::uint64_t counted = patches * (4 * cells + 4 * (cells - 1)) * (8 * cells - 4);
  Work work;
  work.kind = WorkKind::stencil;
  work.read_unique = patches * side * side * 2;
  work.written_unique = work.written_issued = patches * plane * kBins * 4;
  switch (variant) {
    case Variant::cpu:
      votes = patches * (8 * cells - 4) * side;
      work.read_issued = votes * 6;
      break;
    case Variant::gpu: {
      const std::uint64_t across = side + 4 * (cells / kTile - 1);
      votes = patches * across * across;
      work.read_issued = votes * 8;
      work.local_bytes = votes * 4 + counted * 12 + patches * plane * kBins * 8;
      break;
    }
    case Variant::fpga:
      votes = counted;
      work.read_issued = work.read_unique;
      // The patch comes in, a pixel of a cell votes, a bin leaves: one a clock each.
      work.add_loop(patches * side * side, 1, static_cast<std::uint32_t>(patches * 10));
      work.add_loop(patches * plane * 64, 1, static_cast<std::uint32_t>(patches * plane * 14));
      work.add_loop(patches * plane * kBins, 1, static_cast<std::uint32_t>(patches * plane * 4));
      break;
  }
  // Per vote: two differences, nine projections (a sum, a magnitude, a comparison, two choices),
  // the shift; per cell that it counts for a sum.
  work[OpClass::int_add] = votes * (2 + 9 * 6 + 2) + counted;
  work[OpClass::int_mul] = votes * 18 + counted;
  return work;
}

KernelCase histograms_case(const Shape& shape, std::uint32_t seed) {
  std::mt19937 random(seed);
  const std::size_t patches = count_of(shape, "patches");
  HostArray pixels(ElementType::u16, patches * side_of(shape) * side_of(shape));
  for (std::uint16_t& value : pixels.as<std::uint16_t>()) {
    value = static_cast<std::uint16_t>(random() % (255 * 16 + 1));
  }
  return {shape,
          {pixels, HostArray(ElementType::i32, patches * plane_of(shape) * kBins),
           number(shape["cells"]), number(shape["patches"])}};
}

KernelSpec make_histograms() {
  KernelSpec spec = tracking_spec("cell_histograms");
  spec.args = {{"patches", Access::in, ElementType::u16},
               {"histograms", Access::out, ElementType::i32},
               integer("cells"),
               integer("count")};
  spec.geometry = cell_geometry;
  spec.gpu_local_bytes = (36 * 36 + kBins * kTile * kTile) * 4;
  spec.work = histograms_work;
  spec.design = design({{4096, 16, 4, 2}}, {{OpClass::int_add, 80}, {OpClass::int_mul, 20}}, 24, 2);
  spec.make_case = histograms_case;
  spec.golden = [](KernelCase& c) {
    golden_cell_histograms(c.args[0].as<std::uint16_t>(), static_cast<int>(c.shape["cells"]),
                           c.args[1].as<std::int32_t>());
  };
  spec.small_shapes = {{{"cells", 16}, {"patches", 1}}};
  spec.shapes = {{{"cells", 16}, {"patches", 5}}, {{"cells", 32}, {"patches", 3}}};
  return spec;
}

Work features_work(Variant variant, const Shape& shape) {
  const std::uint64_t plane = plane_of(shape);
  const std::uint64_t patches = count_of(shape, "patches");
  const std::uint64_t cells = patches * plane;
  const std::uint64_t histogram = kBins * 4;
  std::uint64_t energies = cells;
  Work work;
  work.kind = WorkKind::stencil;
  work.read_unique = cells * histogram + count_of(shape, "cells") * kFloat;
  work.written_unique = work.written_issued = cells * kChannels * kFloat;
  switch (variant) {
    case Variant::cpu:
      // Three rows' energies, and twice the bins, for each row.
      energies = 3 * cells;
      work.read_issued = cells * 5 * histogram + cells / 16 * 17 * kFloat;
      break;
    case Variant::gpu:
      energies = cells / (kTile * kTile) * (kTile + 2) * (kTile + 2);
      work.read_issued = (energies + cells) * histogram + cells * 2 * kFloat;
      work.local_bytes = (energies + 9 * cells) * kFloat;
      break;
    case Variant::fpga:
      work.read_issued = work.read_unique;
      // In, energies, norms, 31 channels; each chain of operators is filled once per plane.
      work.add_loop(cells * kBins, 1, static_cast<std::uint32_t>(patches * kBins * 10));
      work.add_loop(2 * cells, 1, static_cast<std::uint32_t>(patches * 160));
      work.add_loop(cells * kChannels, 1, static_cast<std::uint32_t>(patches * kChannels * 40));
      break;
  }
  // Per cell: four norms (four sums, a root), of 18 directions each (a product, a cut, two sums)
  // for four blocks and two products, of nine likewise with one sum fewer, of four textures.
  work[OpClass::float_fma] = energies * 9 + cells * 4 * 3;
  work[OpClass::float_mul] = cells * (4 * 7 + 1 + 18 * 6 + 9 * 6 + 4 * 2);
  work[OpClass::float_add] =
      energies * (kEnergyOps - 9) + cells * (4 * (4 + kRootOps - 10) + 18 * 13 + 9 * 9);
  if (variant == Variant::fpga) {
    // Bins are converted once, when they come in; the window's product is made for each feature.
    work[OpClass::float_add] -= cells * 18;
    work[OpClass::float_mul] += cells * (kChannels - 1);
  }
  return work;
}

KernelCase features_case(const Shape& shape, std::uint32_t seed) {
  std::mt19937 random(seed);
  const std::size_t cells = count_of(shape, "patches") * plane_of(shape);
  HostArray histograms(ElementType::i32, cells * kBins);
  for (std::int32_t& value : histograms.as<std::int32_t>()) {
    // Small and large ones, up to the largest that there can be.
    value = static_cast<std::int32_t>(random() % (1u << (1 + random() % 22)));
  }
  return {
      shape,
      {histograms,
       HostArray::of<float>(ElementType::f32,
                            std::span<const float>(taper_table(static_cast<int>(shape["cells"])))),
       HostArray(ElementType::f32, cells * kChannels), number(shape["cells"]),
       number(shape["patches"])}};
}

KernelSpec make_features() {
  KernelSpec spec = tracking_spec("cell_features");
  spec.args = {{"histograms", Access::in, ElementType::i32},
               floats("taper"),
               floats("features", Access::out),
               integer("cells"),
               integer("count")};
  spec.geometry = cell_geometry;
  spec.gpu_local_bytes = (kTile + 2) * (kTile + 2) * kFloat;
  spec.work = features_work;
  spec.design =
      design({{kMaxPlane, 32, kBins, 2}, {kMaxPlane, 32, 8, 2}, {kMaxPlane / 4, 32, 4, 2}},
             {{OpClass::float_fma, 21}, {OpClass::float_mul, 46}, {OpClass::float_add, 70}}, 32, 2);
  spec.make_case = features_case;
  spec.golden = [](KernelCase& c) {
    golden_cell_features(c.args[0].as<std::int32_t>(), c.args[1].as<float>(),
                         static_cast<int>(c.shape["cells"]), c.args[2].as<float>());
  };
  spec.small_shapes = {{{"cells", 16}, {"patches", 1}}};
  spec.shapes = {{{"cells", 16}, {"patches", 5}}, {{"cells", 32}, {"patches", 3}}};
  return spec;
}

}  // namespace

const KernelSpec& resample_spec() {
  static const KernelSpec spec = make_resample();
  return spec;
}

const KernelSpec& cell_histograms_spec() {
  static const KernelSpec spec = make_histograms();
  return spec;
}

const KernelSpec& cell_features_spec() {
  static const KernelSpec spec = make_features();
  return spec;
}

}  // namespace partita::tracking
