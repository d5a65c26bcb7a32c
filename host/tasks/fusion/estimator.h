// Visual-inertial odometry with GPS: moments in, states out. What it keeps is a window of the last
// states (window.h); what it does at each moment is in estimator.cpp, in this order: predict by the
// inertial readings, add what vision, wheels and standing still say, judge the fixes against that,
// add those that are believed, solve.
//
// The world is level but otherwise free until GPS has seen enough of the way to say where it lies
// in the map: then everything is turned and shifted into the map once, and fixes count from there
// on. A vehicle that already moves, with GPS and without a camera, begins in the map.
#ifndef PARTITA_HOST_TASKS_FUSION_ESTIMATOR_H
#define PARTITA_HOST_TASKS_FUSION_ESTIMATOR_H

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "host/tasks/fusion/factors.h"
#include "host/tasks/fusion/initialise.h"
#include "host/tasks/fusion/window.h"

namespace partita::fusion {

struct EstimatorOptions {
  std::size_t window = 10;  ///< states, at least 2
  int iterations = 4;       ///< of the solver at each moment
  ImuNoise noise;
  bool has_imu = true;
  Pose T_imu_cam = Pose::Identity();
  std::optional<WheelConstraint> wheels;
  bool use_ground_velocity = true;  ///< the GPS's speed and course, where it gives them

  /// Errors of neighbouring fixes are alike: within this time they count as one. A receiver's
  /// positions wander for seconds, its speed and course less.
  double gps_correlation_seconds = 4;
  double velocity_correlation_seconds = 0.5;
  double gps_up_factor = 2;    ///< sigma of a fix's height, in those of its position
  double speed_sigma = 0.2;    ///< m/s
  double course_sigma = 0.02;  ///< rad
  /// Receivers smooth: speed and course are what they were so long before.
  double velocity_lag_seconds = 0.6;
  double gate = 5;                  ///< a fix further off, in standard deviations, is rejected
  std::size_t relocate_after = 10;  ///< rejected fixes in a row that agree with each other
};

/// A moment that gets a state: a frame's time, a fix's, or just the next.
struct Moment {
  std::int64_t timestamp_ns = 0;
  /// Vision: the camera's motion since the moment of `reference_ns`.
  std::optional<VisualMotion> motion;
  std::int64_t reference_ns = 0;
  std::vector<GpsFix> fixes;  ///< at most fractions of a second from the moment
};

/// What became of a fix.
struct FixReport {
  enum class Verdict : std::uint8_t { used, rejected, waiting };  ///< waiting: no map yet
  GpsFix fix;
  Vector3d predicted = Vector3d::Zero();  ///< where the vehicle was expected, without this fix
  double sigmas = 0;                      ///< how far off, in standard deviations
  double gap_seconds = 0;                 ///< since the last fix that was used
  Verdict verdict = Verdict::waiting;
};

struct EstimatorCounts {
  std::size_t states = 0;
  std::size_t fixes_used = 0;
  std::size_t fixes_rejected = 0;
  std::size_t fixes_waiting = 0;  ///< before the map was known
  std::size_t relocations = 0;
  std::size_t visual_used = 0;
  std::size_t visual_rejected = 0;
  std::size_t standstill = 0;  ///< moments at rest
  std::size_t unsolved = 0;    ///< moments whose system could not be solved
  double bridged_seconds = 0;  ///< without inertial readings
  double longest_gps_gap = 0;  ///< seconds between fixes that were used
};

class Estimator {
 public:
  explicit Estimator(EstimatorOptions options);

  /// Readings in order of time; those before a moment come before it.
  void add_imu(std::span<const ImuSample> samples);

  /// Moments in order of time. Returns the state there, or nothing while there is none yet.
  std::optional<NavState> step(const Moment& moment);

  bool initialised() const { return !window_.empty(); }
  bool in_map() const { return in_map_; }
  /// Turns and shifts a pose that step() returned before the map was known into the map.
  const Pose& T_map_local() const { return T_map_local_; }
  const EstimatorCounts& counts() const { return counts_; }
  /// Of the fixes of the last step.
  const std::vector<FixReport>& fix_reports() const { return reports_; }
  /// How the first state came about: "at rest", "by GPS", "by vision" or "" before.
  const char* origin() const { return origin_; }
  StateMatrix covariance() const { return window_.newest_covariance(); }

 private:
  void try_initialise(const Moment& moment);
  void begin(const Initial& initial, const char* how);
  void predict(const Moment& moment);
  void add_vision(const Moment& moment, const NavState& predicted);
  void add_wheels(const Moment& moment);
  void add_fixes(const Moment& moment);
  void use_fix(const GpsFix& fix, StateId id, double sigma);
  void use_ground_velocity(const GpsFix& fix);
  /// By how much the standard deviation of a fix grows where so many seconds of them count as one.
  double alike(double seconds) const;
  void judge(const GpsFix& fix, const StateMatrix& covariance);
  void relocate(const GpsFix& fix);
  void align(const Moment& moment);
  void forget_old_readings(std::int64_t before_ns);
  std::span<const ImuSample> readings(std::int64_t from_ns, std::int64_t to_ns) const;

  EstimatorOptions options_;
  std::vector<ImuSample> imu_;
  double imu_step_ = 0;  ///< usual seconds between readings, 0: not known yet
  Window window_;
  std::deque<std::pair<std::int64_t, StateId>> state_times_;
  EstimatorCounts counts_;
  std::vector<FixReport> reports_;
  const char* origin_ = "";

  // Before the first state.
  std::vector<TimedMotion> first_motions_;
  std::vector<GpsFix> first_fixes_;

  // The map.
  bool in_map_ = false;
  Pose T_map_local_ = Pose::Identity();
  struct Pair {
    Vector3d local, map;
  };
  std::vector<Pair> pairs_;
  std::int64_t last_fix_ns_ = 0;
  double fix_period_ = 0;
  std::int64_t last_used_ns_ = 0;
  std::vector<GpsFix> rejected_;  ///< in a row
};

}  // namespace partita::fusion

#endif  // PARTITA_HOST_TASKS_FUSION_ESTIMATOR_H
