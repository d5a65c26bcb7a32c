#include "host/tasks/backend/cases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include <Eigen/Core>

#include "host/runtime/error.h"
#include "host/tasks/backend/camera.h"
#include "host/tasks/backend/golden.h"
#include "host/tasks/backend/structure.h"

namespace partita::backend {
namespace {

using runtime::Access;
using runtime::ArgSpec;
using runtime::ElementType;
using runtime::HostArray;
using runtime::KernelCase;
using runtime::Shape;

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// Uniform numbers that are the same in every standard library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double between(double least, double most) {
    return least + (most - least) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  int below(int bound) { return static_cast<int>(engine_() % static_cast<unsigned>(bound)); }

 private:
  std::mt19937 engine_;
};

/// Arrays by the names of the kernels' arguments.
template <class T>
struct Values {
  std::map<std::string, std::vector<T>, std::less<>> reals;
  std::map<std::string, std::vector<int>, std::less<>> ints;

  golden::Inputs<T> inputs(CameraModel model) const {
    golden::Inputs<T> in;
    in.stereo = model == CameraModel::stereo;
    const auto real = [this](const char* name) -> std::span<const T> {
      const auto found = reals.find(name);
      return found == reals.end() ? std::span<const T>() : found->second;
    };
    const auto integer = [this](const char* name) -> std::span<const int> {
      const auto found = ints.find(name);
      return found == ints.end() ? std::span<const int>() : found->second;
    };
    const auto number = [](auto list, auto otherwise) {
      return list.empty() ? otherwise : list[0];
    };
    in.slots = number(integer("slots"), 0);
    in.points = number(integer("points"), 0);
    in.loss = number(integer("loss"), 0);
    in.loss_scale = number(real("loss_scale"), T(1));
    in.inverse_radius = number(real("inverse_radius"), T(0));
    in.cameras = real("cameras");
    in.state = real("state");
    in.point_scales = real("point_scales");
    in.measured = real("measured");
    in.weights = real("weights");
    in.steps = real("steps");
    in.chunks = integer("chunks");
    in.slot_points = integer("slot_points");
    in.camera_chunks = integer("camera_chunks");
    in.pairs = integer("pairs");
    in.entries = integer("entries");
    in.point_start = integer("point_start");
    in.point_slots = integer("point_slots");
    in.point_cameras = integer("point_cameras");
    in.jacobians = real("jacobians");
    in.partials = real("partials");
    in.blocks = real("blocks");
    in.factors = real("factors");
    in.eliminated = real("eliminated");
    return in;
  }
};

template <std::size_t N>
std::vector<int> flat(const std::vector<std::array<int, N>>& rows) {
  std::vector<int> out;
  for (const auto& row : rows) out.insert(out.end(), row.begin(), row.end());
  return out;
}

template <class T>
Values<T> make_values(const Problem& problem, const Structure& s, int loss, Random& random) {
  const Layout l = layout_of(problem.model);
  Values<T> v;
  std::vector<T>& cameras = v.reals["cameras"];
  for (const Camera& camera : problem.cameras) {
    std::array<double, 9> scales{};
    for (double& scale : scales) scale = random.between(0.002, 0.02);
    for (const double value : camera_record(problem, camera, scales)) {
      cameras.push_back(static_cast<T>(value));
    }
  }
  for (const Point& point : problem.points) {
    for (const double value : point) {
      v.reals["state"].push_back(static_cast<T>(value));
      v.reals["point_scales"].push_back(static_cast<T>(random.between(0.005, 0.02)));
    }
  }
  for (int i = 0; i < l.residuals; ++i) {
    for (const int index : s.slot_observation) {
      v.reals["measured"].push_back(
          index < 0 ? T(0) : static_cast<T>(problem.observations[at(index)].measured[at(i)]));
    }
  }
  for (const int index : s.slot_observation) {
    v.reals["weights"].push_back(
        index < 0 ? T(0) : static_cast<T>(problem.observations[at(index)].weight));
  }
  for (int i = 0; i < s.cameras * kStepStride; ++i) {
    v.reals["steps"].push_back(i % kStepStride < l.dof ? static_cast<T>(random.between(-0.01, 0.01))
                                                       : T(0));
  }
  v.reals["loss_scale"] = {T(1.5)};
  v.reals["inverse_radius"] = {T(1e-4)};
  v.ints["chunks"] = flat(s.chunks);
  v.ints["pairs"] = flat(s.pairs);
  v.ints["entries"] = flat(s.entries);
  v.ints["slot_points"] = s.slot_point;
  v.ints["camera_chunks"] = s.camera_chunks;
  v.ints["point_start"] = s.point_start;
  v.ints["point_slots"] = s.point_slots;
  v.ints["point_cameras"] = s.point_cameras;
  v.ints["slots"] = {s.slots};
  v.ints["points"] = {s.points};
  v.ints["chunk_count"] = {static_cast<int>(s.chunks.size())};
  v.ints["pair_count"] = {static_cast<int>(s.pairs.size())};
  v.ints["loss"] = {loss};
  return v;
}

/// Adds what the golden kernels compute from the values, each from those before it. The outputs are
/// there as zeros as well, for the kernels that write them.
template <class T>
void add_results(Values<T>& v, const Structure& s, CameraModel model) {
  const Layout l = layout_of(model);
  const auto groups = at((s.points + kGroupPoints - 1) / kGroupPoints);
  v.reals["jacobians"].resize(at(s.slots * l.jacobian_stride));
  v.reals["partials"].resize(s.chunks.size() * at(l.partial()));
  golden::jacobian_update<T>(v.inputs(model), v.reals["jacobians"], v.reals["partials"]);
  v.reals["blocks"].resize(at(s.points * kPointBlock));
  v.reals["gradients"].resize(groups);
  golden::point_update<T>(v.inputs(model), v.reals["blocks"], v.reals["gradients"]);
  v.reals["factors"].resize(at(s.points * kPointBlock));
  v.reals["eliminated"].resize(at(s.slots * kEliminatedStride));
  golden::eliminate_points<T>(v.inputs(model), v.reals["factors"], v.reals["eliminated"]);
  v.reals["reduced"].resize(s.pairs.size() * at(l.block()));
  v.reals["camera_sums"].resize(at(s.cameras * 3 * l.dof));
  v.reals["trial"].resize(at(s.points * 3));
  v.reals["sums"].resize(groups * 3);
  v.reals["costs"].resize(s.chunks.size());
}

template <class T>
KernelCase assemble(const std::vector<ArgSpec>& args, const Values<T>& v, const Shape& shape) {
  KernelCase c{shape, {}};
  for (const ArgSpec& arg : args) {
    const bool real = arg.type == ElementType::f32 || arg.type == ElementType::f64;
    if (arg.access == Access::out) {
      c.args.emplace_back(arg.type, v.reals.at(arg.name).size());
    } else if (real) {
      c.args.push_back(HostArray::of<T>(arg.type, v.reals.at(arg.name)));
    } else {
      c.args.push_back(HostArray::of<int>(arg.type, v.ints.at(arg.name)));
    }
  }
  return c;
}

template <class T>
KernelCase typed_case(const std::vector<ArgSpec>& args, CameraModel model, const Shape& shape,
                      std::uint32_t seed) {
  const Problem problem =
      random_problem(model, static_cast<int>(shape["cameras"]), static_cast<int>(shape["points"]),
                     static_cast<int>(shape["seen"]), seed);
  const Structure s = make_structure(problem);
  Random random(seed + 1);
  Values<T> v = make_values<T>(problem, s, static_cast<int>(shape["loss"]), random);
  add_results(v, s, model);
  return assemble(args, v,
                  {{"cameras", s.cameras},
                   {"points", s.points},
                   {"observations", static_cast<std::int64_t>(s.point_slots.size())},
                   {"slots", s.slots},
                   {"chunks", static_cast<std::int64_t>(s.chunks.size())},
                   {"pairs", static_cast<std::int64_t>(s.pairs.size())},
                   {"entries", static_cast<std::int64_t>(s.entries.size())},
                   {"loss", shape["loss"]}});
}

template <class T>
void typed_golden(Golden kernel, const std::vector<ArgSpec>& args, CameraModel model,
                  KernelCase& c) {
  Values<T> v;
  std::vector<std::span<T>> out;
  for (std::size_t i = 0; i < args.size(); ++i) {
    if (args[i].access == Access::out) {
      out.push_back(c.args[i].template as<T>());
    } else if (args[i].type == ElementType::i32) {
      const auto values = c.args[i].template as<int>();
      v.ints[args[i].name].assign(values.begin(), values.end());
    } else {
      const auto values = c.args[i].template as<T>();
      v.reals[args[i].name].assign(values.begin(), values.end());
    }
  }
  const golden::Inputs<T> in = v.inputs(model);
  switch (kernel) {
    case Golden::jacobian_update:
      return golden::jacobian_update(in, out[0], out[1]);
    case Golden::point_update:
      return golden::point_update(in, out[0], out[1]);
    case Golden::eliminate_points:
      return golden::eliminate_points(in, out[0], out[1]);
    case Golden::schur_complement:
      return golden::schur_complement(in, out[0], out[1]);
    case Golden::back_substitute:
      return golden::back_substitute(in, out[0], out[1]);
    case Golden::cost:
      return golden::cost(in, out[0]);
  }
}

std::array<double, 3> seen_at(const Problem& problem, const Camera& camera, const Point& point) {
  const CameraRecord c = camera_record(problem, camera, {1, 1, 1, 1, 1, 1, 1, 1, 1});
  double p[3];
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = c[3 * i] * point[0] + c[3 * i + 1] * point[1] + c[3 * i + 2] * point[2] + c[9 + i];
  }
  if (problem.model == CameraModel::stereo) {
    const StereoRig& rig = problem.rig;
    return {rig.fx * p[0] / p[2] + rig.cx, rig.fy * p[1] / p[2] + rig.cy,
            rig.fx * (p[0] - rig.baseline) / p[2] + rig.cx};
  }
  const double x = -p[0] / p[2], y = -p[1] / p[2], n = x * x + y * y;
  const double factor = camera[6] * (1 + camera[7] * n + camera[8] * n * n);
  return {factor * x, factor * y, 0};
}

}  // namespace

Problem random_problem(CameraModel model, int cameras, int points, int seen, std::uint32_t seed) {
  Random random(seed);
  Problem problem;
  problem.model = model;
  problem.rig = {700, 710, 600, 180, 0.5};
  const double depth = model == CameraModel::bal ? -12 : 12;
  for (int i = 0; i < cameras; ++i) {
    Camera camera{};
    for (std::size_t k = 0; k < 3; ++k) camera[k] = random.between(-0.2, 0.2);
    camera[3] = random.between(-2, 2);
    camera[4] = random.between(-1, 1);
    camera[5] = depth;
    if (model == CameraModel::bal) {
      camera[6] = random.between(400, 900);
      camera[7] = random.between(-0.05, 0.05);
      camera[8] = random.between(-0.01, 0.01);
    }
    problem.cameras.push_back(camera);
  }
  if (cameras > 2) problem.cameras[1][0] = problem.cameras[1][1] = problem.cameras[1][2] = 0;
  for (int i = 0; i < points; ++i) {
    problem.points.push_back({random.between(-3, 3), random.between(-2, 2), random.between(-3, 3)});
    const int drawn = random.below(2 * seen + 1);
    const int count = problem.observations.empty() ? std::max(1, drawn) : drawn;
    for (int k = 0; k < count; ++k) {
      Observation o{.camera = random.below(cameras), .point = i, .weight = random.between(0.5, 1)};
      o.measured = seen_at(problem, problem.cameras[at(o.camera)], problem.points.back());
      for (double& value : o.measured) value += random.between(-0.5, 0.5);
      problem.observations.push_back(o);
    }
  }
  for (Camera& camera : problem.cameras) {
    for (std::size_t k = 0; k < 6; ++k) camera[k] += random.between(-0.005, 0.005);
  }
  for (Point& point : problem.points) {
    for (double& value : point) value += random.between(-0.02, 0.02);
  }
  return problem;
}

KernelCase make_case(const std::vector<ArgSpec>& args, CameraModel model, Precision precision,
                     const Shape& shape, std::uint32_t seed) {
  return precision == Precision::full ? typed_case<double>(args, model, shape, seed)
                                      : typed_case<float>(args, model, shape, seed);
}

void run_golden(Golden kernel, const std::vector<ArgSpec>& args, CameraModel model,
                Precision precision, KernelCase& c) {
  if (precision == Precision::full) {
    typed_golden<double>(kernel, args, model, c);
  } else {
    typed_golden<float>(kernel, args, model, c);
  }
}

}  // namespace partita::backend
