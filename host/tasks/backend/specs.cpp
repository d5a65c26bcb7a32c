// Specs of the bundle adjustment kernels: each in two camera models and two precisions.
#include "host/tasks/backend/cases.h"
#include "host/tasks/backend/kernels.h"
#include "host/tasks/backend/layout.h"
#include "host/tasks/backend/work.h"

namespace partita::backend {
namespace {

using runtime::Access;
using runtime::ArgSpec;
using runtime::ElementType;
using runtime::KernelSpec;
using runtime::LaunchGeometry;
using runtime::Shape;
using runtime::Variant;

std::size_t at_least_one(std::int64_t count) {
  return count < 1 ? 1 : static_cast<std::size_t>(count);
}

/// One work-item (cpu), or one work-group of `items` (gpu), for each of `count`.
LaunchGeometry one_each(Variant variant, std::int64_t count, std::size_t items) {
  const std::size_t n = at_least_one(count);
  if (variant == Variant::gpu) return {{n * items, 1, 1}, {items, 1, 1}};
  return {{n, 1, 1}, {1, 1, 1}};
}

/// Makes the specs of one model in one precision.
class Maker {
 public:
  Maker(CameraModel model, Precision precision)
      : model_(model),
        precision_(precision),
        layout_(layout_of(model)),
        work_{model, precision},
        real_(precision == Precision::full ? ElementType::f64 : ElementType::f32) {}

  Kernels make() const {
    Kernels k{jacobian_update(),  point_update(),    eliminate_points(),
              schur_complement(), back_substitute(), cost()};
    return k;
  }

 private:
  ArgSpec reals(const char* name, Access access = Access::in) const {
    return {name, access, real_};
  }
  static ArgSpec ints(const char* name) { return {name, Access::in, ElementType::i32}; }
  static ArgSpec number(const char* name) { return {name, Access::scalar, ElementType::i32}; }
  ArgSpec real(const char* name) const { return {name, Access::scalar, real_}; }

  KernelSpec begin(const char* name, const char* source, Golden golden,
                   std::vector<ArgSpec> args) const {
    const bool full = precision_ == Precision::full;
    KernelSpec spec;
    spec.name = std::string(name) + (model_ == CameraModel::bal ? "_bal" : "_stereo") +
                (full ? "" : "_single");
    spec.task = "backend";
    spec.source = std::string(source) + (full ? "" : "_single");
    spec.options = model_ == CameraModel::bal ? "-DSTEREO=0" : "-DSTEREO=1";
    spec.variants =
        full ? std::vector{Variant::cpu, Variant::gpu} : std::vector{Variant::cpu, Variant::fpga};
    spec.args = args;
    const CameraModel model = model_;
    const Precision precision = precision_;
    spec.make_case = [args, model, precision](const Shape& shape, std::uint32_t seed) {
      return make_case(args, model, precision, shape, seed);
    };
    spec.golden = [args, model, precision, golden](runtime::KernelCase& c) {
      run_golden(golden, args, model, precision, c);
    };
    const auto shape = [](std::int64_t cameras, std::int64_t points, std::int64_t seen, Loss loss) {
      return Shape{{"cameras", cameras},
                   {"points", points},
                   {"seen", seen},
                   {"loss", static_cast<int>(loss)}};
    };
    spec.small_shapes = {shape(3, 20, 2, Loss::none), shape(5, 70, 3, Loss::huber),
                         shape(2, 60, 2, Loss::cauchy)};
    spec.shapes = {shape(1, 1, 1, Loss::none), shape(7, 300, 4, Loss::cauchy),
                   shape(20, 1500, 4, Loss::huber)};
    return spec;
  }

  /// `count`: which entry of the shape has a work-item or group each; single precision has one.
  void set_geometry(KernelSpec& spec, const char* count, std::int64_t per,
                    std::size_t items) const {
    const bool full = precision_ == Precision::full;
    spec.geometry = [=](Variant variant, const Shape& shape) -> LaunchGeometry {
      if (!full) return {};
      return one_each(variant, (shape[count] + per - 1) / per, items);
    };
  }

  void set_design(KernelSpec& spec, std::initializer_list<OnChipBuffer> buffers,
                  std::initializer_list<std::pair<OpClass, std::uint32_t>> operators,
                  std::uint32_t ports) const {
    if (precision_ == Precision::full) return;
    for (const OnChipBuffer& buffer : buffers)
      spec.design.buffers[spec.design.buffer_count++] = buffer;
    for (const auto& [op, n] : operators) spec.design.operators[static_cast<std::size_t>(op)] = n;
    spec.design.operand_bits = 64;  // the sums
    spec.design.memory_ports = ports;
  }

  /// A fourth of `n`: a slot starts every four cycles.
  static std::uint32_t quarter(int n) { return static_cast<std::uint32_t>((n + 3) / 4); }

  KernelSpec jacobian_update() const {
    KernelSpec spec =
        begin("jacobian_update", "jacobian", Golden::jacobian_update,
              {reals("cameras"), reals("state"), reals("point_scales"), ints("chunks"),
               ints("slot_points"), reals("measured"), reals("weights"),
               reals("jacobians", Access::out), reals("partials", Access::out), number("slots"),
               number("chunk_count"), number("loss"), real("loss_scale")});
    set_geometry(spec, "chunks", 1, kChunk);
    spec.gpu_local_bytes = static_cast<std::uint64_t>(
        (layout_.residuals * layout_.dof + layout_.residuals) * kChunk * 8);
    spec.work = [work = work_](Variant v, const Shape& s) { return work.jacobian_update(v, s); };
    const int rows = layout_.residuals;
    const int terms = rows * (layout_.dof * (layout_.dof + 1) / 2 + layout_.dof);
    set_design(spec, {{64, 32, 1, 2}},
               {{OpClass::float_fma, quarter(20 + 15 * rows)},
                {OpClass::float_mul, quarter(30 + 22 * rows + terms)},
                {OpClass::float_add, quarter(8 + 3 * rows)},
                {OpClass::float_special, 1},
                {OpClass::int_add, static_cast<std::uint32_t>(terms)}},
               3);
    return spec;
  }

  KernelSpec point_update() const {
    KernelSpec spec =
        begin("point_update", "jacobian", Golden::point_update,
              {reals("jacobians"), ints("point_start"), ints("point_slots"), reals("point_scales"),
               reals("blocks", Access::out), reals("gradients", Access::out), number("points")});
    set_geometry(spec, "points", kGroupPoints, kGroupPoints);
    spec.gpu_local_bytes = kGroupPoints * 8;
    spec.work = [work = work_](Variant v, const Shape& s) { return work.point_update(v, s); };
    set_design(spec, {},
               {{OpClass::float_fma, quarter(9 * layout_.residuals)}, {OpClass::float_special, 1}},
               2);
    return spec;
  }

  KernelSpec eliminate_points() const {
    KernelSpec spec =
        begin("eliminate_points", "schur", Golden::eliminate_points,
              {reals("jacobians"), ints("point_start"), ints("point_slots"), reals("blocks"),
               reals("factors", Access::out), reals("eliminated", Access::out), number("points"),
               real("inverse_radius")});
    set_geometry(spec, "points", kGroupPoints, kGroupPoints);
    spec.work = [work = work_](Variant v, const Shape& s) { return work.eliminate_points(v, s); };
    set_design(spec, {{16, 32, 1, 2}},
               {{OpClass::float_fma, quarter((3 + 3 * layout_.dof) * layout_.residuals) + 2},
                {OpClass::float_mul, 3},
                {OpClass::float_add, 2},
                {OpClass::float_special, 2}},
               3);
    return spec;
  }

  KernelSpec schur_complement() const {
    KernelSpec spec = begin("schur_complement", "schur", Golden::schur_complement,
                            {reals("eliminated"), reals("partials"), ints("pairs"), ints("entries"),
                             ints("camera_chunks"), reals("reduced", Access::out),
                             reals("camera_sums", Access::out), number("pair_count")});
    set_geometry(spec, "pairs", 1, static_cast<std::size_t>((layout_.partial() + 31) / 32 * 32));
    spec.work = [work = work_](Variant v, const Shape& s) { return work.schur_complement(v, s); };
    set_design(spec, {{32, 32, 6, 2}},
               {{OpClass::float_fma, quarter(2 * layout_.block())},
                {OpClass::float_mul, quarter(2 * layout_.block())},
                {OpClass::int_add, static_cast<std::uint32_t>(quarter(layout_.block()) * 2)}},
               3);
    return spec;
  }

  KernelSpec back_substitute() const {
    KernelSpec spec =
        begin("back_substitute", "cost", Golden::back_substitute,
              {reals("eliminated"), reals("factors"), reals("blocks"), ints("point_start"),
               ints("point_slots"), ints("point_cameras"), reals("steps"), reals("point_scales"),
               reals("state"), reals("trial", Access::out), reals("sums", Access::out),
               number("points"), real("inverse_radius")});
    set_geometry(spec, "points", kGroupPoints, kGroupPoints);
    spec.gpu_local_bytes = kGroupPoints * 6 * 8;
    spec.work = [work = work_](Variant v, const Shape& s) { return work.back_substitute(v, s); };
    set_design(
        spec, {{512, 32, 1, 2}},
        {{OpClass::float_fma, quarter(27) + 2}, {OpClass::float_mul, 2}, {OpClass::float_add, 6}},
        3);
    return spec;
  }

  KernelSpec cost() const {
    KernelSpec spec =
        begin("cost", "cost", Golden::cost,
              {reals("cameras"), reals("state"), ints("chunks"), ints("slot_points"),
               reals("measured"), reals("weights"), reals("costs", Access::out), number("slots"),
               number("chunk_count"), number("loss"), real("loss_scale")});
    set_geometry(spec, "chunks", 1, kChunk);
    spec.gpu_local_bytes = kChunk * 8;
    spec.work = [work = work_](Variant v, const Shape& s) { return work.cost(v, s); };
    set_design(spec, {{64, 32, 1, 2}},
               {{OpClass::float_fma, 24},
                {OpClass::float_mul, 12},
                {OpClass::float_add, 16},
                {OpClass::float_special, 3}},
               2);
    return spec;
  }

  CameraModel model_;
  Precision precision_;
  Layout layout_;
  WorkModel work_;
  ElementType real_;
};

}  // namespace

Precision precision_of(Variant variant) {
  return variant == Variant::fpga ? Precision::single : Precision::full;
}

std::vector<const KernelSpec*> Kernels::list() const {
  return {&jacobian_update,  &point_update,    &eliminate_points,
          &schur_complement, &back_substitute, &cost};
}

const Kernels& kernels(CameraModel model, Precision precision) {
  static const Kernels bal = Maker(CameraModel::bal, Precision::full).make();
  static const Kernels bal_single = Maker(CameraModel::bal, Precision::single).make();
  static const Kernels stereo = Maker(CameraModel::stereo, Precision::full).make();
  static const Kernels stereo_single = Maker(CameraModel::stereo, Precision::single).make();
  if (model == CameraModel::bal) return precision == Precision::full ? bal : bal_single;
  return precision == Precision::full ? stereo : stereo_single;
}

std::vector<const KernelSpec*> kernel_specs() {
  std::vector<const KernelSpec*> all;
  for (const CameraModel model : {CameraModel::bal, CameraModel::stereo}) {
    for (const Precision precision : {Precision::full, Precision::single}) {
      const auto list = kernels(model, precision).list();
      all.insert(all.end(), list.begin(), list.end());
    }
  }
  return all;
}

}  // namespace partita::backend
