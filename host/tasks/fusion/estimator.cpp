#include "host/tasks/fusion/estimator.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace partita::fusion {
namespace {

constexpr double kReadingsKept = 3;       ///< seconds before the newest state
constexpr double kStillVelocity = 0.02;   ///< standard deviation at rest, m/s
constexpr double kStillSpeed = 0.3;       ///< a faster estimate contradicts standing still, m/s
constexpr double kStillMotion = 0.02;     ///< the camera moves less between moments, metres
constexpr double kMostVisualTurn = 0.06;  ///< vision against the gyro, between moments, rad
constexpr double kMostVisualShift = 0.5;  ///< vision against the prediction, metres
constexpr double kFixesApart = 1e-3;      ///< seconds; closer ones are the same
constexpr double kNoImuBias = 1e-3;       ///< holds what nothing measures
constexpr double kNoImuVelocity = 1.0;
constexpr double kAlignSigmas = 6;  ///< the way must be this long, in a fix's standard deviations
constexpr double kAlignMetres = 5;
constexpr std::int64_t kMostVelocityApartNs = 60'000'000;
constexpr std::size_t kSamplesForStep = 20;
/// After a second without a fix, a prediction is off by more than its covariance knows: tyres slip,
/// roads bank, units are not quite straight. Metres per second of the gap.
constexpr double kBlindDrift = 0.3;
constexpr double kFirstWait = 0.8;  ///< seconds that rest is watched for first

}  // namespace

Estimator::Estimator(EstimatorOptions options)
    : options_(std::move(options)), window_(std::max<std::size_t>(options_.window, 2)) {}

void Estimator::add_imu(std::span<const ImuSample> samples) {
  imu_.insert(imu_.end(), samples.begin(), samples.end());
  if (imu_step_ == 0 && imu_.size() >= kSamplesForStep) {
    imu_step_ = Preintegration::usual_step(imu_);
  }
}

std::span<const ImuSample> Estimator::readings(std::int64_t from_ns, std::int64_t to_ns) const {
  const auto before = [](const ImuSample& s, std::int64_t t) { return s.timestamp_ns < t; };
  auto first = std::lower_bound(imu_.begin(), imu_.end(), from_ns, before);
  auto last = std::lower_bound(first, imu_.end(), to_ns, before);
  if (first != imu_.begin()) --first;  // the neighbours at both ends, to interpolate with
  if (last != imu_.end()) ++last;
  return {first, last};
}

void Estimator::forget_old_readings(std::int64_t before_ns) {
  const auto keep = std::find_if(imu_.begin(), imu_.end(), [before_ns](const ImuSample& s) {
    return s.timestamp_ns >= before_ns;
  });
  // Not every time: moving the rest is the cost.
  if (keep - imu_.begin() > 4000) imu_.erase(imu_.begin(), keep);
}

std::optional<NavState> Estimator::step(const Moment& moment) {
  reports_.clear();
  if (!initialised()) {
    try_initialise(moment);
    if (!initialised()) {
      for (const GpsFix& fix : moment.fixes) {
        reports_.push_back({.fix = fix});
        ++counts_.fixes_waiting;
      }
      return std::nullopt;
    }
    ++counts_.states;
    if (window_.newest().timestamp_ns == moment.timestamp_ns) return window_.newest();
  }
  if (moment.timestamp_ns <= window_.newest().timestamp_ns) return std::nullopt;
  predict(moment);
  add_wheels(moment);
  add_fixes(moment);
  const SolveResult solved = window_.solve(options_.iterations);
  counts_.unsolved += solved.solved ? 0 : 1;
  ++counts_.states;
  forget_old_readings(moment.timestamp_ns - static_cast<std::int64_t>(kReadingsKept * 1e9));
  return window_.newest();
}

void Estimator::try_initialise(const Moment& moment) {
  first_fixes_.insert(first_fixes_.end(), moment.fixes.begin(), moment.fixes.end());
  if (moment.motion) {
    if (!first_motions_.empty() && first_motions_.back().to_ns != moment.reference_ns) {
      first_motions_.clear();
    }
    first_motions_.push_back({moment.reference_ns, moment.timestamp_ns, moment.motion->T_from_to});
  }
  if (!options_.has_imu) {
    Initial initial;
    initial.state.timestamp_ns = moment.timestamp_ns;
    // A camera that is held level: down is along its y axis.
    const Vector3d up = options_.T_imu_cam.linear() * Vector3d(0, -1, 0);
    initial.state.R_world_imu = level(up);
    initial.sigma << 0.05, 0.05, 0.5, Vector3d::Constant(10), Vector3d::Constant(20),
        Vector3d::Constant(kNoImuBias), Vector3d::Constant(kNoImuBias);
    begin(initial, "by vision");
    return;
  }
  const std::int64_t now = moment.timestamp_ns;
  const auto wait_ns = static_cast<std::int64_t>(kFirstWait * 1e9);
  if (imu_.empty() || now - imu_.front().timestamp_ns < wait_ns) return;
  const Rest rest = observe_rest(readings(now - wait_ns, now));
  bool moves = false;
  for (const TimedMotion& m : first_motions_) {
    moves = moves || m.T_from_to.translation().norm() > kStillMotion;
  }
  if (!first_fixes_.empty() && first_fixes_.back().speed) {
    moves = moves || *first_fixes_.back().speed > kStillSpeed;
  }
  const bool seen_still = !first_motions_.empty() && rest.steady;
  if ((rest.still || seen_still) && !moves) {
    begin(initialise_at_rest(rest, now, options_.noise), "at rest");
  } else if (!first_motions_.empty()) {
    const auto initial =
        initialise_by_vision(imu_, first_motions_, options_.T_imu_cam, options_.noise);
    if (initial && initial->state.timestamp_ns == now) begin(*initial, "by vision");
  } else {
    const Matrix3d vehicle =
        options_.wheels ? options_.wheels->R_imu_vehicle : Matrix3d::Identity();
    const auto initial = initialise_by_gps(imu_, first_fixes_, vehicle, options_.noise,
                                           options_.velocity_lag_seconds);
    if (initial) begin(*initial, "by GPS");
  }
}

void Estimator::begin(const Initial& initial, const char* how) {
  window_.restart(initial.state, initial.sigma);
  state_times_.assign(1, {initial.state.timestamp_ns, window_.states().last()});
  origin_ = how;
  in_map_ = initial.in_map;
  last_used_ns_ = initial.state.timestamp_ns;
}

void Estimator::predict(const Moment& moment) {
  const NavState from = window_.newest();
  const StateId from_id = window_.states().last();
  NavState predicted = from;
  predicted.timestamp_ns = moment.timestamp_ns;
  std::optional<Preintegration> measured;
  if (options_.has_imu) {
    measured.emplace(from.bias, options_.noise);
    measured->integrate(readings(from.timestamp_ns, moment.timestamp_ns), from.timestamp_ns,
                        moment.timestamp_ns, imu_step_);
    counts_.bridged_seconds += measured->bridged_seconds();
    predicted = measured->predict(from);
    predicted.timestamp_ns = moment.timestamp_ns;
  } else {
    predicted.position += from.velocity * seconds_between(from.timestamp_ns, moment.timestamp_ns);
  }
  const StateId id = window_.push(predicted);
  state_times_.emplace_back(moment.timestamp_ns, id);
  while (!window_.states().contains(state_times_.front().second)) state_times_.pop_front();
  if (measured) {
    window_.add(inertial_factor(from_id, *measured));
  } else {
    StateVector sigma = StateVector::Zero();
    sigma.segment<3>(kVelocity).setConstant(kNoImuVelocity);
    sigma.tail<6>().setConstant(kNoImuBias);
    window_.add(prior_factor(id, predicted, sigma));
  }
  add_vision(moment, predicted);
}

void Estimator::add_vision(const Moment& moment, const NavState& predicted) {
  if (!moment.motion) return;
  const auto reference =
      std::find_if(state_times_.begin(), state_times_.end(),
                   [&](const auto& entry) { return entry.first == moment.reference_ns; });
  if (reference == state_times_.end()) return;  // it has left the window, or never was in it
  if (options_.has_imu) {
    // A motion that the inertial readings cannot have missed is a mistake of vision's: moving
    // objects that fill the picture, repeated patterns.
    const NavState& from = window_.states().at(reference->second);
    const Pose expected = (from.T_world_imu() * options_.T_imu_cam).inverse() *
                          predicted.T_world_imu() * options_.T_imu_cam;
    const Pose off = moment.motion->T_from_to.inverse() * expected;
    const double seconds = seconds_between(reference->first, moment.timestamp_ns);
    const double tolerance = std::max(1.0, seconds / 0.1);
    if (so3::log(off.linear()).norm() > kMostVisualTurn * tolerance ||
        off.translation().norm() > kMostVisualShift * tolerance * tolerance) {
      ++counts_.visual_rejected;
      return;
    }
  }
  ++counts_.visual_used;
  window_.add(visual_factor(reference->second, state_times_.back().second, *moment.motion,
                            options_.T_imu_cam));
}

void Estimator::add_wheels(const Moment& moment) {
  const StateId id = window_.states().last();
  // Roads do slope, and a camera ahead of the rear axle does move sideways on a bend: what vision
  // sees of the motion is better than that.
  if (options_.wheels && !moment.motion) {
    window_.add(wheel_factor(id, *options_.wheels));
    if (const auto& times = state_times_; times.size() > 1) {
      const std::int64_t before = times[times.size() - 2].first;
      window_.add(
          steady_factor(id - 1, *options_.wheels, seconds_between(before, moment.timestamp_ns)));
    }
  }
  if (!options_.has_imu) return;
  const auto wait_ns = static_cast<std::int64_t>(kFirstWait * 1e9);
  const Rest rest = observe_rest(readings(moment.timestamp_ns - wait_ns, moment.timestamp_ns));
  const bool seen_moving =
      (moment.motion && moment.motion->T_from_to.translation().norm() > kStillMotion) ||
      window_.newest().velocity.norm() > kStillSpeed;
  const bool seen_still = moment.motion && rest.steady;
  if (!(rest.still || seen_still) || seen_moving) return;
  ++counts_.standstill;
  window_.add(standstill_factor(id, rest.mean_gyro, kStillVelocity,
                                options_.noise.gyro_density / std::sqrt(rest.seconds) + 1e-4));
}

void Estimator::add_fixes(const Moment& moment) {
  if (moment.fixes.empty()) return;
  if (!in_map_) {
    align(moment);
    return;
  }
  window_.solve(options_.iterations);
  const StateMatrix covariance = window_.newest_covariance();
  for (const GpsFix& fix : moment.fixes) {
    const double since = seconds_between(last_fix_ns_, fix.timestamp_ns);
    if (last_fix_ns_ != 0 && since < kFixesApart) continue;
    if (last_fix_ns_ != 0 && since < 2) fix_period_ = since;
    last_fix_ns_ = fix.timestamp_ns;
    judge(fix, covariance);
  }
}

void Estimator::judge(const GpsFix& fix, const StateMatrix& covariance) {
  const NavState& state = window_.newest();
  const double seconds = seconds_between(state.timestamp_ns, fix.timestamp_ns);
  FixReport report{.fix = fix};
  report.predicted = state.position + state.velocity * seconds;
  report.gap_seconds = seconds_between(last_used_ns_, fix.timestamp_ns);
  Eigen::Matrix2d spread = covariance.block<2, 2>(kPosition, kPosition);
  const double drift = report.gap_seconds > 1 ? kBlindDrift * report.gap_seconds : 0;
  spread.diagonal().array() += fix.sigma * fix.sigma + drift * drift;
  const Eigen::Vector2d off = (fix.position - report.predicted).head<2>();
  report.sigmas = std::sqrt(std::max(0.0, off.dot(spread.ldlt().solve(off))));
  if (report.sigmas <= options_.gate) {
    report.verdict = FixReport::Verdict::used;
    use_fix(fix, window_.states().last(), fix.sigma);
    rejected_.clear();
  } else {
    report.verdict = FixReport::Verdict::rejected;
    ++counts_.fixes_rejected;
    relocate(fix);
  }
  reports_.push_back(report);
}

void Estimator::use_fix(const GpsFix& fix, StateId id, double sigma) {
  const NavState& state = window_.states().at(id);
  const double weighted = sigma * alike(options_.gps_correlation_seconds);
  window_.add(position_factor(id, {.position = fix.position,
                                   .seconds = seconds_between(state.timestamp_ns, fix.timestamp_ns),
                                   .sigma = weighted,
                                   .sigma_up = weighted * options_.gps_up_factor}));
  if (options_.use_ground_velocity && fix.speed && fix.course) use_ground_velocity(fix);
  counts_.longest_gps_gap =
      std::max(counts_.longest_gps_gap, seconds_between(last_used_ns_, fix.timestamp_ns));
  last_used_ns_ = fix.timestamp_ns;
  ++counts_.fixes_used;
}

double Estimator::alike(double seconds) const {
  return fix_period_ > 0 ? std::sqrt(std::max(1.0, seconds / fix_period_)) : 1.0;
}

void Estimator::use_ground_velocity(const GpsFix& fix) {
  const auto then =
      fix.timestamp_ns - static_cast<std::int64_t>(options_.velocity_lag_seconds * 1e9);
  const auto apart = [then](const auto& entry) { return std::abs(entry.first - then); };
  const auto nearest =
      std::min_element(state_times_.begin(), state_times_.end(),
                       [&apart](const auto& a, const auto& b) { return apart(a) < apart(b); });
  // Of a time from before the window, it would be taken for a later one.
  if (apart(*nearest) > kMostVelocityApartNs) return;
  const Eigen::Vector2d velocity(*fix.speed * std::sin(*fix.course),
                                 *fix.speed * std::cos(*fix.course));
  const double grown = alike(options_.velocity_correlation_seconds);
  const double along = options_.speed_sigma * grown;
  const double across = along + *fix.speed * options_.course_sigma * grown;
  window_.add(ground_velocity_factor(nearest->second, velocity, along, across));
}

/// One fix far off is an outlier; many in a row that move as the vehicle does are where it is.
void Estimator::relocate(const GpsFix& fix) {
  if (!rejected_.empty()) {
    const GpsFix& before = rejected_.back();
    const double seconds = seconds_between(before.timestamp_ns, fix.timestamp_ns);
    const Vector3d moved = fix.position - before.position;
    const double off = (moved - window_.newest().velocity * seconds).head<2>().norm();
    if (off > 4 * (before.sigma + fix.sigma) + 3 * seconds) rejected_.clear();
  }
  rejected_.push_back(fix);
  if (rejected_.size() < options_.relocate_after) return;
  NavState state = window_.newest();
  state.position =
      fix.position + state.velocity * seconds_between(fix.timestamp_ns, state.timestamp_ns);
  StateVector sigma = window_.newest_covariance().diagonal().cwiseMax(1e-12).cwiseSqrt() * 2;
  sigma.segment<3>(kPosition).setConstant(2 * std::max(fix.sigma, 1.0));
  window_.restart(state, sigma);
  state_times_.assign(1, {state.timestamp_ns, window_.states().last()});
  ++counts_.relocations;
  rejected_.clear();
}

/// Where the free world lies in the map: the turn about the vertical and the shift that take the
/// way of the states onto that of the fixes, by least squares, once both are long enough.
void Estimator::align(const Moment& moment) {
  window_.solve(options_.iterations);
  const NavState& state = window_.newest();
  for (const GpsFix& fix : moment.fixes) {
    const double seconds = seconds_between(state.timestamp_ns, fix.timestamp_ns);
    pairs_.push_back({state.position + state.velocity * seconds, fix.position});
    reports_.push_back({.fix = fix});
    ++counts_.fixes_waiting;
  }
  const Pair& newest = pairs_.back();
  const double enough = std::max(kAlignMetres, kAlignSigmas * moment.fixes.back().sigma);
  double local = 0, map = 0;
  Vector3d mean_local = Vector3d::Zero(), mean_map = Vector3d::Zero();
  const auto count = static_cast<double>(pairs_.size());
  for (const Pair& pair : pairs_) {
    local = std::max(local, (pair.local - newest.local).head<2>().norm());
    map = std::max(map, (pair.map - newest.map).head<2>().norm());
    mean_local += pair.local / count;
    mean_map += pair.map / count;
  }
  if (local < enough || map < enough) return;
  double sine = 0, cosine = 0;
  for (const Pair& pair : pairs_) {
    const Vector3d a = pair.local - mean_local, b = pair.map - mean_map;
    sine += a.x() * b.y() - a.y() * b.x();
    cosine += a.x() * b.x() + a.y() * b.y();
  }
  T_map_local_.linear() = so3::exp(Vector3d(0, 0, std::atan2(sine, cosine)));
  T_map_local_.translation() = mean_map - T_map_local_.linear() * mean_local;
  // An outlier among them shows as a misfit: wait for more, without the worst.
  std::size_t worst = 0;
  double squares = 0, most = 0;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const double off = (T_map_local_ * pairs_[i].local - pairs_[i].map).head<2>().squaredNorm();
    squares += off / count;
    if (off <= most) continue;
    most = off;
    worst = i;
  }
  if (std::sqrt(squares) > 3 * std::max(moment.fixes.back().sigma, 0.5)) {
    pairs_.erase(pairs_.begin() + static_cast<std::ptrdiff_t>(worst));
    T_map_local_ = Pose::Identity();
    return;
  }
  window_.move_world(T_map_local_);
  in_map_ = true;
  last_used_ns_ = moment.timestamp_ns;
  pairs_.clear();
}

}  // namespace partita::fusion
