// Specs of spectra, correlate, respond and train: the correlation filter.
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
using enum OpClass;

constexpr std::uint64_t kComplex = 8;
constexpr std::uint64_t kExpOps = 14;

std::uint64_t butterflies_of(const Shape& shape) {
  return plane_of(shape) * stages_of(shape);  // n^2 / 2 in each stage of either direction
}

/// A butterfly: a complex product, two complex sums, a sign.
void add_transforms(Work& work, const Shape& shape, std::uint64_t planes) {
  work[float_fma] += planes * butterflies_of(shape) * 2;
  work[float_mul] += planes * butterflies_of(shape) * 2;
  work[float_add] += planes * butterflies_of(shape) * 5;
}

/// Bytes of twiddles that the transforms of `planes` planes ask for.
std::uint64_t twiddle_bytes(Variant variant, const Shape& shape, std::uint64_t planes) {
  switch (variant) {
    case Variant::cpu:
      return planes * butterflies_of(shape) / count_of(shape, "cells") * kComplex;
    case Variant::gpu:
      return planes * butterflies_of(shape) * kComplex;
    case Variant::fpga:
      break;
  }
  return count_of(shape, "cells") * kFloat;  // once, into a table
}

/// A stage reads and writes every entry of a plane.
std::uint64_t transform_local_bytes(const Shape& shape, std::uint64_t planes) {
  return planes * butterflies_of(shape) * 4 * kComplex;
}

/// A clock per butterfly; each stage fills the pipeline (load, product, sum, store) anew.
void add_transform_loop(Work& work, const Shape& shape, std::uint64_t planes) {
  work.add_loop(planes * butterflies_of(shape), 1,
                static_cast<std::uint32_t>(planes * 2 * stages_of(shape) * 24));
}

template <const char* Count>
LaunchGeometry plane_geometry(Variant variant, const Shape& shape) {
  const std::uint64_t planes = count_of(shape, Count);
  switch (variant) {
    case Variant::cpu:
      return items(planes);
    case Variant::gpu:
      return groups(planes, kPlaneItems);
    case Variant::fpga:
      break;
  }
  return {};
}
constexpr char kPlanes[] = "planes";
constexpr char kPatches[] = "patches";

HostArray twiddles_of(const Shape& shape) {
  return HostArray::of<float>(
      ElementType::f32, std::span<const float>(twiddle_table(static_cast<int>(shape["cells"]))));
}
int cells_of(const KernelCase& c) {
  return static_cast<int>(c.shape["cells"]);
}
int scales_of(const KernelCase& c) {
  return static_cast<int>(c.shape["scales"]);
}

/// Slots in some order, and one more than are in use.
HostArray slots_for(std::uint64_t targets, std::mt19937& random) {
  std::vector<std::int32_t> slots(targets + 1);
  for (std::size_t i = 0; i < slots.size(); ++i) slots[i] = static_cast<std::int32_t>(i);
  for (std::size_t i = slots.size() - 1; i > 0; --i) std::swap(slots[i], slots[random() % (i + 1)]);
  slots.resize(targets);
  return HostArray::of<std::int32_t>(ElementType::i32, std::span<const std::int32_t>(slots));
}

Work spectra_work(Variant variant, const Shape& shape) {
  const std::uint64_t planes = count_of(shape, "planes");
  const std::uint64_t entries = planes * plane_of(shape);
  Work work;
  work.kind = WorkKind::gather;
  add_transforms(work, shape, planes);
  work.read_issued = entries * kFloat + twiddle_bytes(variant, shape, planes);
  work.read_unique = entries * kFloat + count_of(shape, "cells") * kFloat;
  work.written_issued = work.written_unique = entries * kComplex;
  if (variant == Variant::gpu) {
    work.local_bytes = transform_local_bytes(shape, planes) + 2 * entries * kComplex;
  }
  if (variant == Variant::fpga) {
    work.add_loop(entries, 1, static_cast<std::uint32_t>(planes * 10));
    add_transform_loop(work, shape, planes);
    work.add_loop(2 * entries, 1, static_cast<std::uint32_t>(planes * 6));
  }
  return work;
}

const OnChipBuffer kPlaneBuffer{kMaxPlane / 2, 32, 4, 2};  // real and imaginary, two banks each
const OnChipBuffer kTableBuffer{kMaxCells, 32, 1, 2};

KernelSpec make_spectra() {
  KernelSpec spec = tracking_spec("spectra");
  spec.args = {floats("planes"), floats("twiddles"), floats("spectra", Access::out),
               integer("cells"), integer("count")};
  spec.geometry = plane_geometry<kPlanes>;
  spec.gpu_local_bytes = 2 * kMaxPlane * kFloat;
  spec.work = spectra_work;
  spec.design = design({kPlaneBuffer, kTableBuffer},
                       {{float_fma, 2}, {float_mul, 2}, {float_add, 4}, {int_add, 8}}, 32, 2);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    std::mt19937 random(seed);
    const std::size_t entries = count_of(shape, "planes") * plane_of(shape);
    return KernelCase{shape,
                      {random_floats(entries, -1, 1, random), twiddles_of(shape),
                       HostArray(ElementType::f32, 2 * entries), number(shape["cells"]),
                       number(shape["planes"])}};
  };
  spec.golden = [](KernelCase& c) {
    golden_spectra(c.args[0].as<float>(), c.args[1].as<float>(), cells_of(c),
                   c.args[2].as<float>());
  };
  spec.small_shapes = {{{"cells", 16}, {"planes", 2}}};
  spec.shapes = {{{"cells", 16}, {"planes", 93}}, {{"cells", 32}, {"planes", 31}}};
  return spec;
}

Work correlate_work(Variant variant, const Shape& shape) {
  const std::uint64_t patches = count_of(shape, "patches");
  const std::uint64_t entries = patches * plane_of(shape);
  const std::uint64_t targets = patches / count_of(shape, "scales");
  const std::uint64_t model = plane_of(shape) * kChannels * kComplex;
  Work work;
  work.kind = WorkKind::stream;
  // Per channel: a product with a conjugate, two squares; per entry two sums, a distance, its
  // exponential.
  work[float_fma] = entries * (kChannels * 8 + 1 + 9);
  work[float_add] = entries * (kChannels + 2 + 1 + kExpOps - 10);
  work[float_mul] = entries * 2;
  add_transforms(work, shape, 2 * patches);
  work.read_unique = (patches + targets) * model + count_of(shape, "cells") * kFloat;
  work.written_issued = work.written_unique = entries * kComplex;
  work.read_issued = patches * 2 * model + twiddle_bytes(variant, shape, 2 * patches) +
                     patches * 4 * (variant == Variant::gpu ? kPlaneItems : 1);
  if (variant == Variant::gpu) {
    work.local_bytes = transform_local_bytes(shape, 2 * patches) + entries * 14 * kFloat;
  }
  if (variant == Variant::fpga) {
    // Two numbers of an entry come through each port: two clocks.
    work.add_loop(entries * kChannels, 2, static_cast<std::uint32_t>(patches * kChannels * 40));
    work.add_loop(2 * entries, 1, static_cast<std::uint32_t>(patches * 4 * stages_of(shape) * 14));
    add_transform_loop(work, shape, 2 * patches);
    work.add_loop(3 * entries, 1, static_cast<std::uint32_t>(patches * 100));
  }
  return work;
}

KernelSpec make_correlate() {
  KernelSpec spec = tracking_spec("correlate");
  spec.args = {floats("models"),
               floats("spectra"),
               {"slots", Access::in, ElementType::i32},
               floats("twiddles"),
               floats("kernels", Access::out),
               integer("cells"),
               integer("scales"),
               integer("count"),
               {"falloff", Access::scalar, ElementType::f32}};
  spec.geometry = plane_geometry<kPatches>;
  spec.gpu_local_bytes = 4 * kMaxPlane * kFloat;
  spec.work = correlate_work;
  spec.design = design({kPlaneBuffer, kTableBuffer, {kMaxPlane, 32, 2, 2}},
                       {{float_fma, 24}, {float_mul, 8}, {float_add, 22}, {int_add, 20}}, 32, 3);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    std::mt19937 random(seed);
    const std::size_t patches = count_of(shape, "patches");
    const std::size_t targets = patches / count_of(shape, "scales");
    const std::size_t model = 2 * kChannels * plane_of(shape);
    // Distances of a few: neither all ones nor all zeros.
    const float falloff = 3.0f / static_cast<float>(model);
    return KernelCase{
        shape,
        {random_floats((targets + 1) * model, -1, 1, random),
         random_floats(patches * model, -1, 1, random), slots_for(targets, random),
         twiddles_of(shape), HostArray(ElementType::f32, 2 * patches * plane_of(shape)),
         number(shape["cells"]), number(shape["scales"]), number(shape["patches"]),
         real(falloff * static_cast<float>(plane_of(shape)))}};
  };
  spec.golden = [](KernelCase& c) {
    golden_correlate(c.args[0].as<float>(), c.args[1].as<float>(), c.args[2].as<std::int32_t>(),
                     c.args[3].as<float>(), cells_of(c), scales_of(c), c.args[8].as<float>()[0],
                     c.args[4].as<float>());
  };
  spec.small_shapes = {{{"cells", 16}, {"patches", 2}, {"scales", 2}}};
  spec.shapes = {{{"cells", 16}, {"patches", 15}, {"scales", 3}},
                 {{"cells", 32}, {"patches", 5}, {"scales", 1}}};
  return spec;
}

Work respond_work(Variant variant, const Shape& shape) {
  const std::uint64_t patches = count_of(shape, "patches");
  const std::uint64_t entries = patches * plane_of(shape);
  Work work;
  work.kind = WorkKind::reduce;
  work[float_fma] = entries * 2;
  work[float_mul] = entries * 2;
  work[float_add] = entries * 2;  // a sign, a comparison
  add_transforms(work, shape, patches);
  work.read_issued = entries * 2 * kComplex + twiddle_bytes(variant, shape, patches) +
                     patches * 4 * (variant == Variant::gpu ? kPlaneItems : 1);
  work.read_unique =
      entries * kComplex + patches / count_of(shape, "scales") * plane_of(shape) * kComplex;
  work.written_issued = work.written_unique = patches * kPeakEntries * kFloat;
  if (variant == Variant::gpu) {
    work.local_bytes = transform_local_bytes(shape, patches) + entries * 4 * kFloat;
  }
  if (variant == Variant::fpga) {
    work.add_loop(entries, 2, static_cast<std::uint32_t>(patches * 20));
    add_transform_loop(work, shape, patches);
    work.add_loop(entries, 1, static_cast<std::uint32_t>(patches * 20));
  }
  return work;
}

KernelSpec make_respond() {
  KernelSpec spec = tracking_spec("respond");
  spec.args = {floats("kernels"),
               floats("filters"),
               {"slots", Access::in, ElementType::i32},
               floats("twiddles"),
               floats("peaks", Access::out),
               integer("cells"),
               integer("scales"),
               integer("count")};
  spec.geometry = plane_geometry<kPatches>;
  spec.gpu_local_bytes = 2 * kMaxPlane * kFloat + kPlaneItems * 8;
  spec.work = respond_work;
  spec.design = design({kPlaneBuffer, kTableBuffer},
                       {{float_fma, 4}, {float_mul, 5}, {float_add, 5}, {int_add, 12}}, 32, 3);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    std::mt19937 random(seed);
    const std::size_t patches = count_of(shape, "patches");
    const std::size_t targets = patches / count_of(shape, "scales");
    HostArray kernels = random_floats(2 * patches * plane_of(shape), -1, 1, random);
    // The last patch answers the same everywhere: the first place has to be taken.
    const auto last = kernels.as<float>().last(2 * plane_of(shape));
    std::fill(last.begin(), last.end(), 0.0f);
    return KernelCase{shape,
                      {kernels, random_floats((targets + 1) * 2 * plane_of(shape), -1, 1, random),
                       slots_for(targets, random), twiddles_of(shape),
                       HostArray(ElementType::f32, patches * kPeakEntries), number(shape["cells"]),
                       number(shape["scales"]), number(shape["patches"])}};
  };
  spec.golden = [](KernelCase& c) {
    golden_respond(c.args[0].as<float>(), c.args[1].as<float>(), c.args[2].as<std::int32_t>(),
                   c.args[3].as<float>(), cells_of(c), scales_of(c), c.args[4].as<float>());
  };
  spec.small_shapes = {{{"cells", 16}, {"patches", 2}, {"scales", 2}}};
  spec.shapes = {{{"cells", 16}, {"patches", 15}, {"scales", 3}},
                 {{"cells", 32}, {"patches", 5}, {"scales", 1}}};
  return spec;
}

LaunchGeometry train_geometry(Variant variant, const Shape& shape) {
  const std::uint64_t targets = count_of(shape, "targets");
  switch (variant) {
    case Variant::cpu:
      return items(kChannels, targets);
    case Variant::gpu:
      return {{2 * kChannels * plane_of(shape), targets, 1}, {kPlaneItems, 1, 1}};
    case Variant::fpga:
      break;
  }
  return {};
}

Work train_work(Variant variant, const Shape& shape) {
  const std::uint64_t targets = count_of(shape, "targets");
  const std::uint64_t entries = targets * plane_of(shape);
  const std::uint64_t numbers = entries * 2 * kChannels;
  Work work;
  work.kind = WorkKind::stream;
  // A number of the model: a comparison, a difference, an fma. An entry of the filter: a complex
  // quotient, and two numbers as the model's.
  work[float_fma] = numbers + entries * (1 + 8 + 2 + 2);
  work[float_add] = numbers * 2 + entries * (1 + 4 + 1 + 4);
  work[float_mul] = entries * 5;
  work.read_unique = numbers * 2 * kFloat + entries * 4 * kFloat + plane_of(shape) * kComplex;
  work.written_issued = work.written_unique = numbers * kFloat + entries * kComplex;
  work.read_issued = numbers * 2 * kFloat + entries * 6 * kFloat;
  switch (variant) {
    case Variant::cpu:
      work.read_issued += targets * kChannels * 8;
      break;
    case Variant::gpu:
      work.read_issued += numbers * 8;  // slot and rate
      break;
    case Variant::fpga:
      work.read_issued += targets * 8;
      work.add_loop(numbers, 1, static_cast<std::uint32_t>(targets * 30));
      work.add_loop(entries, 2, static_cast<std::uint32_t>(targets * 90));
      break;
  }
  return work;
}

KernelSpec make_train() {
  KernelSpec spec = tracking_spec("train");
  spec.args = {floats("kernels"),
               floats("spectra"),
               floats("label"),
               {"slots", Access::in, ElementType::i32},
               floats("rates"),
               floats("filters", Access::inout),
               floats("models", Access::inout),
               integer("cells"),
               integer("count"),
               {"regularisation", Access::scalar, ElementType::f32}};
  spec.geometry = train_geometry;
  spec.work = train_work;
  spec.design = design({}, {{float_fma, 14}, {float_mul, 5}, {float_add, 12}}, 32, 5);
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    std::mt19937 random(seed);
    const std::size_t targets = count_of(shape, "targets");
    const std::size_t plane = 2 * plane_of(shape);
    HostArray rates = random_floats(targets, 0, 1, random);
    if (targets > 2) rates.as<float>()[1] = 1;  // a new target's
    return KernelCase{shape,
                      {random_floats(targets * plane, -1, 1, random),
                       random_floats(targets * kChannels * plane, -1, 1, random),
                       random_floats(plane, -1, 1, random), slots_for(targets, random), rates,
                       random_floats((targets + 1) * plane, -1, 1, random),
                       random_floats((targets + 1) * kChannels * plane, -1, 1, random),
                       number(shape["cells"]), number(shape["targets"]), real(1e-4f)}};
  };
  spec.golden = [](KernelCase& c) {
    golden_train(c.args[0].as<float>(), c.args[1].as<float>(), c.args[2].as<float>(),
                 c.args[3].as<std::int32_t>(), c.args[4].as<float>(), c.args[9].as<float>()[0],
                 cells_of(c), c.args[5].as<float>(), c.args[6].as<float>());
  };
  spec.small_shapes = {{{"cells", 16}, {"targets", 1}}};
  spec.shapes = {{{"cells", 16}, {"targets", 7}}, {{"cells", 32}, {"targets", 3}}};
  return spec;
}

}  // namespace

const KernelSpec& spectra_spec() {
  static const KernelSpec spec = make_spectra();
  return spec;
}
const KernelSpec& correlate_spec() {
  static const KernelSpec spec = make_correlate();
  return spec;
}
const KernelSpec& respond_spec() {
  static const KernelSpec spec = make_respond();
  return spec;
}
const KernelSpec& train_spec() {
  static const KernelSpec spec = make_train();
  return spec;
}

std::vector<const KernelSpec*> kernel_specs() {
  return {&resample_spec(),  &cell_histograms_spec(), &cell_features_spec(), &spectra_spec(),
          &correlate_spec(), &respond_spec(),         &train_spec()};
}

}  // namespace partita::tracking
