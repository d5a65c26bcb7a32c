#include "host/tasks/backend/solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/host_step.h"
#include "host/tasks/backend/device_problem.h"
#include "host/tasks/backend/reduced_system.h"

namespace partita::backend {
namespace {

// Ceres's trust region (TrustRegionMinimizer and LevenbergMarquardtStrategy with its defaults).
constexpr double kLargestRadius = 1e16, kSmallestRadius = 1e-32;
constexpr double kLeastDiagonal = 1e-6, kLargestDiagonal = 1e32;
constexpr double kLeastGain = 1e-3;
constexpr int kInvalidSteps = 5;  ///< one after the other, then it gives up
/// Of the columns until their norms are known: their squares then fit into fixed-point sums.
constexpr double kFirstScale = 1.0 / 4096;
/// In single precision, what fixed-point sums hold (kernels/backend/float1.clh).
constexpr double kLargestFixed = 4194304;

double now() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// Adds the time until its end to a part, on both clocks.
class PartTimer {
 public:
  PartTimer(Part part, const runtime::Session& session, Summary& summary)
      : index_(static_cast<std::size_t>(part)), session_(session), summary_(summary) {}
  ~PartTimer() {
    summary_.parts[index_] += now() - began_;
    summary_.predicted[index_] +=
        static_cast<double>(session_.extension().host_clock() - virtual_began_) * 1e-9;
  }
  PartTimer(const PartTimer&) = delete;
  PartTimer& operator=(const PartTimer&) = delete;

 private:
  std::size_t index_;
  const runtime::Session& session_;
  Summary& summary_;
  double began_ = now();
  std::uint64_t virtual_began_ = session_.extension().host_clock();
};

template <class T>
class Minimiser {
 public:
  Minimiser(const runtime::Session& session, Problem& problem, const SolverOptions& options,
            Summary& summary)
      : session_(session),
        problem_(problem),
        options_(options),
        summary_(summary),
        began_(now()),
        structure_(make_structure(problem)),
        dof_(static_cast<std::size_t>(layout_of(problem.model).dof)),
        device_(session, problem, structure_, options.loss, options.loss_scale),
        system_(make_reduced_system(structure_, static_cast<int>(dof_))),
        scales_(problem.cameras.size(), unit_scales()),
        trial_(problem.cameras) {
    for (std::size_t c = 0; c < problem.fixed.size(); ++c) {
      if (problem.fixed[c]) scales_[c].fill(0);
    }
    summary_.linear_solver = system_->name();
  }

  double start_cost() {
    write_cameras(0, problem_.cameras);
    const PartTimer timer(Part::cc, session_, summary_);
    return device_.cost(0);
  }

  void run(const std::function<void(const Iteration&)>& progress) {
    cost_ = summary_.initial_cost = start_cost();
    if (!std::isfinite(cost_)) {
      throw Error(
          "bundle adjustment: the start has no finite cost: a point lies in the plane of a camera "
          "that sees it, or a value is out of range");
    }
    choose_scales();
    linearise();
    summary_.setup_seconds = now() - began_;
    record({.number = 0, .cost = cost_, .radius = radius_}, began_, progress);
    while (summary_.termination.empty()) iterate(progress);
    device_.read_points(problem_.points);
    summary_.final_cost = cost_;
    summary_.total_seconds = now() - began_;
  }

 private:
  static std::array<double, 9> unit_scales() {
    std::array<double, 9> ones;
    ones.fill(1);
    return ones;
  }

  void write_cameras(int state, const std::vector<Camera>& cameras) {
    records_.resize(cameras.size());
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      records_[i] = camera_record(problem_, cameras[i], scales_[i]);
    }
    device_.write_cameras(state, records_);
  }

  /// Jacobi scaling by the columns where it starts: 1 / (1 + norm).
  void choose_scales() {
    const PartTimer timer(Part::ju, session_, summary_);
    std::vector<double> cameras, points(problem_.points.size() * 3, 1.0);
    for (auto& scales : scales_) {
      for (double& value : scales) value *= kFirstScale;
    }
    write_cameras(0, problem_.cameras);
    device_.write_point_scales(points);
    device_.update_jacobians();
    device_.read_diagonals(cameras, points);
    const auto scale = [](double square) { return 1 / (1 + std::sqrt(square)); };
    for (std::size_t i = 0; i < cameras.size(); ++i)
      scales_[i / dof_][i % dof_] *= scale(cameras[i] / (kFirstScale * kFirstScale)) / kFirstScale;
    for (double& value : points) value = scale(value);
    device_.write_point_scales(points);
    write_cameras(0, problem_.cameras);
  }

  void linearise() {
    const PartTimer timer(Part::ju, session_, summary_);
    device_.update_jacobians();
    gradient_ = device_.point_gradient();
    fresh_ = true;
  }

  double scale_of(std::size_t unknown) const { return scales_[unknown / dof_][unknown % dof_]; }

  void eliminate() {
    const PartTimer timer(Part::se, session_, summary_);
    device_.eliminate(1 / radius_, reduced_);
  }

  /// One entry of a camera's sums: 0 right-hand side, 1 gradient, 2 diagonal.
  double sum_of(std::size_t unknown, std::size_t which) const {
    return reduced_.camera_sums[unknown / dof_ * 3 * dof_ + which * dof_ + unknown % dof_];
  }

  /// False if there is no step.
  bool factorise() {
    const PartTimer timer(Part::cfs, session_, summary_);
    const std::size_t n = problem_.cameras.size() * dof_;
    damping_.resize(n);
    rhs_.resize(n);
    step_.resize(n);
    bool in_range = true;
    for (std::size_t i = 0; i < n; ++i) {
      const double diagonal = sum_of(i, 2);
      in_range &= sizeof(T) == sizeof(double) || diagonal < kLargestFixed;
      damping_[i] = std::clamp(diagonal, kLeastDiagonal, kLargestDiagonal) / radius_;
      rhs_[i] = sum_of(i, 0);
      if (scale_of(i) == 0) {  // fixed
        damping_[i] = 1;
        rhs_[i] = 0;
      }
    }
    const bool solved = in_range && system_->solve(reduced_.blocks, damping_, rhs_, step_);
    runtime::declare_host_step(session_, factorise_spec(),
                               {{"unknowns", static_cast<std::int64_t>(n)},
                                {"terms", static_cast<std::int64_t>(system_->multiply_adds())}});
    return solved;
  }

  /// Cost of the trial state; the model's decrease and the lengths of step and state with it.
  double try_step() {
    const PartTimer timer(Part::cc, session_, summary_);
    model_ = step_square_ = norm_square_ = 0;
    for (std::size_t c = 0; c < problem_.cameras.size(); ++c) {
      std::array<double, 9> move{};
      for (std::size_t i = 0; i < dof_; ++i) {
        const std::size_t k = c * dof_ + i;
        move[i] = step_[k] * scale_of(k);
        model_ += (damping_[k] * step_[k] - sum_of(k, 1)) * step_[k];
        step_square_ += move[i] * move[i];
        norm_square_ += problem_.cameras[c][i] * problem_.cameras[c][i];
      }
      const bool fixed = !problem_.fixed.empty() && problem_.fixed[c];
      if (!fixed) trial_[c] = moved(problem_.model, problem_.cameras[c], move);
    }
    write_cameras(1, trial_);
    const PointStep points = device_.step_points(step_, 1 / radius_);
    model_ = 0.5 * (model_ + points.model);
    step_square_ += points.square;
    norm_square_ += points.norm;
    return model_ > 0 ? device_.cost(1) : 0;
  }

  void take_step(double cost, double gain) {
    problem_.cameras = trial_;
    device_.accept();
    cost_ = cost;
    radius_ = std::min(radius_ / std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3)), kLargestRadius);
    decrease_ = 2;
  }

  void shrink() {
    radius_ /= decrease_;
    decrease_ *= 2;
  }

  void iterate(const std::function<void(const Iteration&)>& progress) {
    const double began = now();
    Iteration it{.number = summary_.steps() + 1, .cost = cost_, .gradient = gradient_};
    if (it.number > options_.max_iterations) return end(false, "the most iterations allowed");
    if (radius_ < kSmallestRadius) return end(false, "the trust region has vanished");
    eliminate();
    if (fresh_ && camera_gradient() <= options_.gradient_tolerance) {
      return end(true, "gradient below the gradient tolerance");
    }
    it.gradient = gradient_;
    fresh_ = false;
    const bool solved = factorise();
    const double trial_cost = solved ? try_step() : 0;
    if (!solved || !(model_ > 0)) {
      if (++invalid_ >= kInvalidSteps) return end(false, "no valid step: the system is singular");
      shrink();
      it.radius = radius_;
      return record(it, began, progress);
    }
    invalid_ = 0;
    judge(trial_cost, it);
    if (it.accepted && summary_.termination.empty()) linearise();
    it.cost = cost_;
    it.radius = radius_;
    record(it, began, progress);
  }

  /// GRE: is the step taken, how far does the next one reach, is this the end?
  void judge(double trial_cost, Iteration& it) {
    const PartTimer timer(Part::gre, session_, summary_);
    runtime::declare_host_step(session_, gain_ratio_spec(),
                               {{"unknowns", static_cast<std::int64_t>(step_.size())}});
    it.step = std::sqrt(step_square_);
    if (it.step <=
        options_.parameter_tolerance * (std::sqrt(norm_square_) + options_.parameter_tolerance)) {
      return end(true, "step below the parameter tolerance");
    }
    it.cost_change = cost_ - trial_cost;
    it.gain = it.cost_change / model_;
    const bool small = std::abs(it.cost_change) <= options_.function_tolerance * cost_;
    // Ceres leaves a last step below the tolerance undone; one that gains is worth keeping.
    it.accepted = std::isfinite(trial_cost) && it.gain > kLeastGain;
    if (it.accepted) {
      take_step(trial_cost, it.gain);
    } else {
      shrink();
    }
    if (small) end(true, "change of cost below the function tolerance");
  }

  double camera_gradient() {
    for (std::size_t i = 0; i < problem_.cameras.size() * dof_; ++i) {
      if (scale_of(i) != 0) gradient_ = std::max(gradient_, std::abs(sum_of(i, 1)) / scale_of(i));
    }
    return gradient_;
  }

  void end(bool converged, const char* why) {
    summary_.converged = converged;
    summary_.termination = why;
  }

  void record(Iteration it, double began, const std::function<void(const Iteration&)>& progress) {
    it.seconds = now() - began;
    summary_.iterations.push_back(it);
    if (progress) progress(it);
  }

  const runtime::Session& session_;
  Problem& problem_;
  const SolverOptions& options_;
  Summary& summary_;
  double began_;
  Structure structure_;
  std::size_t dof_;
  DeviceProblem<T> device_;
  std::unique_ptr<ReducedSystem> system_;
  std::vector<std::array<double, 9>> scales_;  ///< of the cameras' columns; 0: fixed
  std::vector<Camera> trial_;
  std::vector<CameraRecord> records_;
  Reduced reduced_;
  std::vector<double> damping_, rhs_, step_;
  double cost_ = 0, gradient_ = 0, model_ = 0, step_square_ = 0, norm_square_ = 0;
  double radius_ = options_.initial_radius, decrease_ = 2;
  int invalid_ = 0;
  bool fresh_ = true;  ///< the Jacobians are new: the gradient has not been looked at
};

}  // namespace

const char* to_string(Part part) {
  switch (part) {
    case Part::ju:
      return "JU";
    case Part::se:
      return "SE";
    case Part::cfs:
      return "CFS";
    case Part::cc:
      return "CC";
    case Part::gre:
      return "GRE";
  }
  return "?";
}

BundleAdjuster::BundleAdjuster(const runtime::Session& session, CameraModel model)
    : session_(session), model_(model), precision_(precision_of(session.charged())) {}

Summary BundleAdjuster::solve(Problem& problem, const SolverOptions& options,
                              const std::function<void(const Iteration&)>& progress) const {
  if (problem.model != model_) throw Error("bundle adjustment: kernels of another camera model");
  if (problem.observations.empty()) throw Error("bundle adjustment: no observation");
  Summary summary;
  if (precision_ == Precision::full) {
    Minimiser<double>(session_, problem, options, summary).run(progress);
  } else {
    Minimiser<float>(session_, problem, options, summary).run(progress);
  }
  return summary;
}

double BundleAdjuster::cost(const Problem& problem, const SolverOptions& options) const {
  Problem copy = problem;
  Summary summary;
  if (precision_ == Precision::full) {
    return Minimiser<double>(session_, copy, options, summary).start_cost();
  }
  return Minimiser<float>(session_, copy, options, summary).start_cost();
}

}  // namespace partita::backend
