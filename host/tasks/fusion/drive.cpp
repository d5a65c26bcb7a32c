#include "host/tasks/fusion/drive.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace partita::fusion {
namespace {

constexpr std::int64_t kPeriodNs = 100'000'000;  ///< of moments that nothing else makes

bool in_gap(std::int64_t time_ns, std::span<const GpsGap> gaps) {
  return std::any_of(gaps.begin(), gaps.end(), [time_ns](const GpsGap& g) {
    return time_ns > g.from_ns && time_ns < g.to_ns;
  });
}

/// Fixes with after < time <= until, outside the gaps.
std::vector<GpsFix> fixes_between(const SensorLog& log, std::int64_t after, std::int64_t until,
                                  std::span<const GpsGap> gaps) {
  std::vector<GpsFix> result;
  auto fix = std::upper_bound(log.gps.begin(), log.gps.end(), after,
                              [](std::int64_t t, const GpsFix& f) { return t < f.timestamp_ns; });
  for (; fix != log.gps.end() && fix->timestamp_ns <= until; ++fix) {
    if (!in_gap(fix->timestamp_ns, gaps)) result.push_back(*fix);
  }
  return result;
}

std::vector<Moment> moments_of_frames(const SensorLog& log, std::span<const VisualFrame> frames,
                                      std::span<const GpsGap> gaps) {
  std::vector<Moment> moments;
  for (const VisualFrame& frame : frames) {
    const std::int64_t before =
        moments.empty() ? frame.timestamp_ns - kPeriodNs : moments.back().timestamp_ns;
    moments.push_back({.timestamp_ns = frame.timestamp_ns,
                       .motion = frame.motion,
                       .reference_ns = frame.reference_ns,
                       .fixes = fixes_between(log, before, frame.timestamp_ns, gaps)});
  }
  return moments;
}

/// At every fix, and often enough in between.
std::vector<Moment> moments_of_fixes(const SensorLog& log, std::span<const GpsGap> gaps) {
  std::vector<Moment> moments;
  if (log.imu.empty()) return moments;
  const std::int64_t end = log.imu.back().timestamp_ns;
  std::int64_t now = log.imu.front().timestamp_ns;
  while (now < end) {
    const std::int64_t next = std::min(now + kPeriodNs, end);
    // A fix takes the place of the moment that it is close to.
    const auto fixes = fixes_between(log, now, next + kPeriodNs / 2, gaps);
    const auto taken = std::find_if(fixes.begin(), fixes.end(), [now](const GpsFix& f) {
      return f.timestamp_ns >= now + kPeriodNs / 4;
    });
    const std::int64_t time = taken != fixes.end() ? std::min(taken->timestamp_ns, end) : next;
    moments.push_back({.timestamp_ns = time, .fixes = fixes_between(log, now, time, gaps)});
    now = time;
  }
  return moments;
}

/// Hands the readings up to a moment over, a little beyond it so that it can be interpolated at.
class ImuFeed {
 public:
  explicit ImuFeed(const std::vector<ImuSample>& samples) : samples_(samples) {}
  void advance(Estimator& estimator, std::int64_t until_ns) {
    std::size_t end = next_;
    while (end < samples_.size() && (end == 0 || samples_[end - 1].timestamp_ns < until_ns)) ++end;
    estimator.add_imu(std::span(samples_).subspan(next_, end - next_));
    next_ = end;
  }

 private:
  const std::vector<ImuSample>& samples_;
  std::size_t next_ = 0;
};

}  // namespace

EstimatorOptions options_for(const SensorLog& log) {
  EstimatorOptions options;
  options.noise = log.noise;
  options.has_imu = !log.imu.empty();
  options.T_imu_cam = log.T_imu_cam;
  if (log.R_imu_vehicle) options.wheels = WheelConstraint{.R_imu_vehicle = *log.R_imu_vehicle};
  return options;
}

DriveResult localize(const SensorLog& log, std::span<const VisualFrame> frames,
                     const EstimatorOptions& options, std::span<const GpsGap> gaps,
                     const std::function<void(std::size_t, std::size_t)>& progress) {
  DriveResult result;
  Estimator estimator(options);
  ImuFeed imu(log.imu);
  const std::vector<Moment> moments =
      frames.empty() ? moments_of_fixes(log, gaps) : moments_of_frames(log, frames, gaps);
  result.moments = moments.size();
  std::size_t local = 0;  // states that came before the map was known
  for (std::size_t i = 0; i < moments.size(); ++i) {
    imu.advance(estimator, moments[i].timestamp_ns);
    const bool was_in_map = estimator.in_map();
    if (const auto state = estimator.step(moments[i])) result.states.push_back(*state);
    if (!was_in_map && estimator.in_map()) {
      // The state of this very moment is in the map already.
      local = result.states.empty() ? 0 : result.states.size() - 1;
    }
    const auto& reports = estimator.fix_reports();
    result.fixes.insert(result.fixes.end(), reports.begin(), reports.end());
    if (progress) progress(i + 1, moments.size());
  }
  for (std::size_t i = 0; i < local; ++i) {
    NavState& s = result.states[i];
    s.R_world_imu = estimator.T_map_local().linear() * s.R_world_imu;
    s.position = estimator.T_map_local() * s.position;
    s.velocity = estimator.T_map_local().linear() * s.velocity;
  }
  result.counts = estimator.counts();
  result.in_map = estimator.in_map();
  result.origin = estimator.origin();
  return result;
}

std::vector<GapError> all_gaps(const SensorLog& log, const EstimatorOptions& options,
                               double seconds, std::size_t every,
                               const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<GapError> errors;
  std::size_t gap = 0;
  Estimator estimator(options);
  ImuFeed imu(log.imu);
  const std::vector<Moment> moments = moments_of_fixes(log, {});
  for (std::size_t i = 0; i < moments.size(); ++i) {
    imu.advance(estimator, moments[i].timestamp_ns);
    estimator.step(moments[i]);
    if (progress) progress(i + 1, moments.size());
    if (!estimator.in_map() || moments[i].fixes.empty()) continue;
    const GpsFix& last = moments[i].fixes.back();
    const auto back = std::find_if(log.gps.begin(), log.gps.end(), [&](const GpsFix& f) {
      return seconds_between(last.timestamp_ns, f.timestamp_ns) >= seconds - 1e-6;
    });
    if (back == log.gps.end()) continue;
    if (gap++ % std::max<std::size_t>(every, 1) != 0) continue;
    Estimator blind = estimator;
    ImuFeed rest = imu;
    std::optional<NavState> state;
    for (std::int64_t now = moments[i].timestamp_ns; now < back->timestamp_ns;) {
      now = std::min(now + kPeriodNs, back->timestamp_ns);
      rest.advance(blind, now);
      state = blind.step({.timestamp_ns = now});
    }
    if (!state) continue;
    const Eigen::Vector2d off = (state->position - back->position).head<2>();
    Eigen::Matrix2d spread = blind.covariance().block<2, 2>(kPosition, kPosition);
    spread.diagonal().array() += back->sigma * back->sigma;
    const Eigen::Vector2d way = (back->position - last.position).head<2>().normalized();
    errors.push_back({.from_ns = last.timestamp_ns,
                      .seconds = seconds_between(last.timestamp_ns, back->timestamp_ns),
                      .error = off.norm(),
                      .ahead = off.dot(way),
                      .left = way.x() * off.y() - way.y() * off.x(),
                      .sigmas = std::sqrt(std::max(0.0, off.dot(spread.ldlt().solve(off)))),
                      .travelled = (back->position - last.position).head<2>().norm()});
  }
  return errors;
}

}  // namespace partita::fusion
