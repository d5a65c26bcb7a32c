// Operations are counted from the formulas in kernels/backend/*.clh, per slot, point or entry.
#include "host/tasks/backend/work.h"

namespace partita::backend {
namespace {

using runtime::Shape;
using runtime::Variant;

/// Operations of one kind of number.
struct Ops {
  std::uint64_t add = 0, mul = 0, fma = 0, special = 0;

  Ops operator+(const Ops& o) const {
    return {add + o.add, mul + o.mul, fma + o.fma, special + o.special};
  }
  Ops operator*(std::uint64_t n) const { return {add * n, mul * n, fma * n, special * n}; }
};

std::uint64_t count(const Shape& shape, const char* name) {
  return static_cast<std::uint64_t>(shape[name]);
}

std::uint64_t groups(const Shape& shape) {
  return (count(shape, "points") + kGroupPoints - 1) / kGroupPoints;
}

/// What the formulas need to know.
struct Terms {
  std::uint64_t dof, residuals, upper, block, partial, jacobian, bytes;
  bool stereo, single;

  explicit Terms(const WorkModel& m) {
    const Layout l = layout_of(m.model);
    dof = static_cast<std::uint64_t>(l.dof);
    residuals = static_cast<std::uint64_t>(l.residuals);
    upper = dof * (dof + 1) / 2;
    block = dof * dof;
    partial = block + dof;
    jacobian = static_cast<std::uint64_t>(l.jacobian_stride);
    stereo = m.model == CameraModel::stereo;
    single = m.precision == Precision::single;
    bytes = single ? 4 : 8;
  }

  /// Rotation, translation, perspective, measurement; BAL's distortion.
  Ops project() const { return stereo ? Ops{7, 6, 9, 1} : Ops{5, 7, 11, 1}; }
  Ops derivative() const { return stereo ? Ops{4, 8, 0, 0} : Ops{0, 13, 5, 0}; }
  Ops squared_norm() const { return {0, 1, residuals - 1, 0}; }
  Ops loss_weight(const Shape& shape) const {
    const auto loss = static_cast<Loss>(shape["loss"]);
    if (loss == Loss::huber) return {2, 1, 0, 3};
    if (loss == Loss::cauchy) return {1, 1, 0, 3};
    return {};
  }
  Ops loss_value(const Shape& shape) const {
    const auto loss = static_cast<Loss>(shape["loss"]);
    if (loss == Loss::huber) return {1, 1, 0, 0};  // most residuals are small
    if (loss == Loss::cauchy) return {9, 3, 12, 2};
    return {};
  }
  /// A row of Jc and Jp: weight, cross product, rotation's and translation's columns, R.
  Ops row() const { return stereo ? Ops{3, 18, 15, 0} : Ops{3, 25, 15, 0}; }
  Ops linearise(const Shape& shape) const {
    const Ops weights{0, 2 * residuals + 1, 0, 0};
    return project() + derivative() + squared_norm() + loss_weight(shape) + weights +
           row() * residuals;
  }
  /// A term of a fixed-point sum beyond the product: scaling and clamping; conversion, addition.
  Ops to_fixed() const { return {2, 1, 0, 0}; }

  void declare(Work& work, const Ops& ops) const {
    work[single ? OpClass::float_add : OpClass::double_add] += ops.add;
    work[single ? OpClass::float_mul : OpClass::double_mul] += ops.mul;
    work[single ? OpClass::float_fma : OpClass::double_fma] += ops.fma;
    work[single ? OpClass::float_special : OpClass::double_special] += ops.special;
  }
};

constexpr std::uint64_t kInt = 4;
/// A camera's record, as far as the kernels read it.
constexpr std::uint64_t kRecord = 30;
/// The circuits start a slot, an observation or an entry every four cycles: a fourth of its
/// operations then exist side by side.
constexpr std::uint32_t kInterval = 4;

void set_bytes(Work& work, std::uint64_t read, std::uint64_t unique, std::uint64_t written) {
  work.read_issued = read;
  work.read_unique = unique;
  work.written_issued = work.written_unique = written;
}

}  // namespace

Work WorkModel::jacobian_update(Variant variant, const Shape& shape) const {
  const Terms t(*this);
  const std::uint64_t slots = count(shape, "slots"), chunks = count(shape, "chunks"),
                      points = count(shape, "points"), cameras = count(shape, "cameras");
  Work work;
  work.kind = WorkKind::gather;
  t.declare(work, t.linearise(shape) * slots);
  const std::uint64_t terms = t.residuals * (t.upper + t.dof);
  if (t.single) {
    t.declare(work, (Ops{0, 1, 0, 0} + t.to_fixed()) * (slots * terms) +
                        Ops{0, 1, 0, 0} * (chunks * t.partial));
    work[OpClass::int_add] = slots * terms * 2 + chunks * t.partial;
  } else if (variant == Variant::gpu) {
    t.declare(work, Ops{0, 0, t.residuals * t.partial, 0} * slots +
                        Ops{7, 0, 0, 0} * (chunks * t.partial));
  } else {
    t.declare(work, Ops{0, 0, terms, 0} * slots + Ops{7, 0, 0, 0} * (chunks * (t.upper + t.dof)));
  }
  const std::uint64_t slot_read = kInt + (6 + t.residuals + 1) * t.bytes;
  const std::uint64_t camera_reads = variant == Variant::cpu && !t.single ? slots / kLanes : slots;
  set_bytes(work, slots * slot_read + camera_reads * kRecord * t.bytes + chunks * 16,
            slots * (kInt + (t.residuals + 1) * t.bytes) + points * 6 * t.bytes +
                cameras * kRecord * t.bytes + chunks * 16,
            (slots * t.jacobian + chunks * t.partial) * t.bytes);
  if (variant == Variant::gpu) {
    const std::uint64_t rows = t.residuals * t.dof + t.residuals;
    work.local_bytes = slots * (rows + 2 * t.residuals * t.partial) * t.bytes;
    work.read_issued += chunks * (kChunk - 1) * 16;
  }
  if (variant == Variant::fpga) {
    work.add_loop(chunks * kRecord, 1, 40);
    work.add_loop(slots, kInterval, 220);
    work.add_loop(chunks * t.partial, 1, 20);
  }
  return work;
}

Work WorkModel::point_update(Variant variant, const Shape& shape) const {
  const Terms t(*this);
  const std::uint64_t seen = count(shape, "observations"), points = count(shape, "points");
  Work work;
  work.kind = WorkKind::gather;
  t.declare(work, Ops{0, 0, 9 * t.residuals, 0} * seen + Ops{6, 0, 0, 3} * points);
  const std::uint64_t per_point = 2 * kInt + 3 * t.bytes;
  set_bytes(work, seen * (kInt + 4 * t.residuals * t.bytes) + points * per_point,
            seen * (kInt + 4 * t.residuals * t.bytes) + points * (kInt + 3 * t.bytes),
            (points * kPointBlock + groups(shape)) * t.bytes);
  if (variant == Variant::gpu) work.local_bytes = groups(shape) * 64 * 2 * t.bytes;
  if (variant == Variant::fpga) {
    work.add_loop(seen, kInterval, 30);
    work.add_loop(points, kInterval, 60);
  }
  return work;
}

Work WorkModel::eliminate_points(Variant variant, const Shape& shape) const {
  const Terms t(*this);
  const std::uint64_t seen = count(shape, "observations"), points = count(shape, "points");
  Work work;
  work.kind = WorkKind::gather;
  // Damping 6 comparisons, 3 mul; three pivots; L and y. A row of A: 3 mul, 3 fma; Z: 3 fma a
  // column.
  t.declare(work, Ops{6 + 3 + 2 + 8, 3 + 2 + 4, 7, 6} * points +
                      Ops{3, 3, 3 + 3 * t.dof, 0} * (seen * t.residuals));
  const std::uint64_t per_slot = t.residuals * (3 + t.dof) * t.bytes;
  set_bytes(work, seen * (kInt + per_slot) + points * (2 * kInt + kPointBlock * t.bytes),
            seen * (kInt + per_slot) + points * (kInt + kPointBlock * t.bytes),
            (points * kPointBlock + seen * kEliminatedStride) * t.bytes);
  if (variant == Variant::cpu && t.stereo && !t.single) {
    work.read_issued += seen * t.residuals * 2 * t.bytes;  // rows filled up to eight
  }
  if (variant == Variant::fpga) {
    work.add_loop(points, 8, 200);
    work.add_loop(seen, kInterval, 60);
  }
  return work;
}

Work WorkModel::schur_complement(Variant variant, const Shape& shape) const {
  const Terms t(*this);
  const std::uint64_t entries = count(shape, "entries"), pairs = count(shape, "pairs"),
                      chunks = count(shape, "chunks"), cameras = count(shape, "cameras"),
                      seen = count(shape, "observations");
  Work work;
  work.kind = WorkKind::dense;
  if (t.single) {
    const Ops term = Ops{0, 1, 2, 0} + t.to_fixed();
    t.declare(work, term * (entries * t.block + seen * t.dof) +
                        t.to_fixed() * (chunks * t.partial) +
                        Ops{0, 1, 0, 0} * (pairs * t.block + cameras * 3 * t.dof));
    work[OpClass::int_add] = (entries * t.block + seen * t.dof + chunks * t.partial) * 2;
  } else {
    t.declare(work, Ops{0, 0, 3, 0} * (entries * t.block + seen * t.dof) +
                        Ops{1, 0, 0, 0} * (chunks * t.partial));
  }
  const std::uint64_t z = 3 * t.dof * t.bytes;
  set_bytes(work, 0,
            entries * 8 + seen * (z + 3 * t.bytes) + chunks * t.partial * t.bytes + pairs * 16,
            (pairs * t.block + cameras * 3 * t.dof) * t.bytes);
  if (variant == Variant::gpu) {
    work.read_issued = (pairs * t.block + cameras * t.dof) * 16 + entries * t.block * 8 +
                       entries * t.block * 6 * t.bytes + seen * t.dof * (8 + 6 * t.bytes) +
                       chunks * t.partial * t.bytes + cameras * t.partial * 2 * kInt;
    // Work-items of one group read the same lines.
  } else {
    // The CPU variant reads rows of eight, and BAL's first factor as scalars and as vectors.
    const std::uint64_t both = t.single ? 2 * z : (t.stereo ? 18 + 24 : 51 + 27) * t.bytes;
    work.read_issued = pairs * 16 + entries * (8 + both) + seen * 3 * t.bytes +
                       chunks * t.partial * t.bytes + cameras * 2 * kInt;
  }
  if (variant == Variant::fpga) {
    work.add_loop(chunks * t.partial, 1, 20);
    work.add_loop(entries, kInterval, 60);
    work.add_loop(pairs * t.block, 1, 20);
  }
  return work;
}

Work WorkModel::back_substitute(Variant variant, const Shape& shape) const {
  const Terms t(*this);
  const std::uint64_t seen = count(shape, "observations"), points = count(shape, "points"),
                      cameras = count(shape, "cameras");
  Work work;
  work.kind = WorkKind::gather;
  // 27 products a slot; 24 additions of lanes, the triangular solve, the three sums.
  t.declare(work,
            Ops{0, 0, 27, 0} * seen + Ops{24 + 10 + 3 + 6 + 3, 3 + 3 + 3, 3 + 3 * 4, 0} * points);
  set_bytes(work,
            seen * (2 * kInt + (27 + 9) * t.bytes) + points * (2 * kInt + (9 + 6 + 6) * t.bytes),
            seen * (2 * kInt + 27 * t.bytes) + cameras * 9 * t.bytes +
                points * (kInt + (9 + 6 + 6) * t.bytes),
            (points * 3 + groups(shape) * 3) * t.bytes);
  if (variant == Variant::gpu) {
    work.local_bytes = points * 12 * t.bytes;
    work.read_issued += points * 3 * t.bytes;
  }
  if (variant == Variant::fpga) {
    work.add_loop(seen, kInterval, 40);
    work.add_loop(points, 8, 120);
  }
  return work;
}

Work WorkModel::cost(Variant variant, const Shape& shape) const {
  const Terms t(*this);
  const std::uint64_t slots = count(shape, "slots"), chunks = count(shape, "chunks"),
                      points = count(shape, "points"), cameras = count(shape, "cameras");
  constexpr std::uint64_t kRead = 17;  ///< of a camera's record
  Work work;
  work.kind = WorkKind::gather;
  t.declare(
      work,
      (t.project() + t.squared_norm() + t.loss_value(shape) + Ops{1, t.residuals, 0, 0}) * slots +
          Ops{7, 0, 0, 0} * chunks);
  const std::uint64_t slot_read = kInt + (3 + t.residuals + 1) * t.bytes;
  const std::uint64_t record = (t.stereo ? kRead : kRead - 2) * t.bytes;
  const std::uint64_t camera_reads = variant == Variant::cpu && !t.single ? slots / kLanes : slots;
  set_bytes(work, slots * slot_read + camera_reads * record + chunks * 16,
            slots * (kInt + (t.residuals + 1) * t.bytes) + points * 3 * t.bytes + cameras * record +
                chunks * 16,
            chunks * t.bytes);
  if (variant == Variant::gpu) {
    work.local_bytes = slots * 2 * t.bytes;
    work.read_issued += chunks * (kChunk - 1) * 16;
  }
  if (variant == Variant::fpga) {
    work.add_loop(chunks * kRead, 1, 40);
    work.add_loop(slots, 1, 120);
    work.add_loop(chunks, 8, 30);
  }
  return work;
}

}  // namespace partita::backend
