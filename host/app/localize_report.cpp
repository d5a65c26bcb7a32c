// What `partita localize` prints and writes.
#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "host/app/localize.h"
#include "host/app/plot_axis.h"
#include "host/io/file.h"

namespace partita::app {
namespace {

const char* to_string(fusion::FixReport::Verdict verdict) {
  switch (verdict) {
    case fusion::FixReport::Verdict::used:
      return "used";
    case fusion::FixReport::Verdict::rejected:
      return "rejected";
    case fusion::FixReport::Verdict::waiting:
      return "waiting";
  }
  return "";
}

Json to_json(const Compared& compared) {
  Json json;
  const io::TrajectoryError& e = *compared.error;
  json["poses"] = compared.truth.size();
  json["distance_m"] = e.distance;
  json["end_error_m"] = e.end_error;
  json["end_error_percent"] = e.end_error_percent;
  json["ate_rmse_m"] = e.ate_rmse;
  json["ate_percent"] = e.distance > 0 ? 100 * e.ate_rmse / e.distance : 0;
  if (compared.relative) {
    json["rpe_translation_rmse_m"] = compared.relative->translation_rmse;
    json["rpe_rotation_rmse_degrees"] = compared.relative->rotation_rmse_degrees;
  }
  if (e.segment) {
    json["t_rel_percent"] = e.segment->translation_percent;
    json["r_rel_degrees_per_100m"] = e.segment->rotation_degrees_per_100m;
    json["segments"] = e.segment->segments;
  }
  return json;
}

std::string line(const char* name, const Compared& compared) {
  const io::TrajectoryError& e = *compared.error;
  std::string text = fmt::format(
      "{:<20}ATE {:.3f} m ({:.3f} % of {:.1f} m), end error {:.3f} m "
      "({:.2f} %)",
      name, e.ate_rmse, e.distance > 0 ? 100 * e.ate_rmse / e.distance : 0, e.distance, e.end_error,
      e.end_error_percent);
  if (compared.relative) {
    text += fmt::format(", RPE {:.4f} m {:.4f} deg", compared.relative->translation_rmse,
                        compared.relative->rotation_rmse_degrees);
  }
  if (e.segment) {
    text += fmt::format(", t_rel {:.2f} %, r_rel {:.2f} deg/100 m", e.segment->translation_percent,
                        e.segment->rotation_degrees_per_100m);
  }
  return text + "\n";
}

struct GapSummary {
  double median = 0, p90 = 0, worst = 0, within_10 = 0;
};
GapSummary summary(const std::vector<fusion::GapError>& gaps) {
  std::vector<double> errors;
  for (const fusion::GapError& gap : gaps) errors.push_back(gap.error);
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  };
  const auto within = std::count_if(errors.begin(), errors.end(), [](double e) { return e <= 10; });
  return {at(0.5), at(0.9), errors.back(),
          100 * static_cast<double>(within) / static_cast<double>(errors.size())};
}

}  // namespace

std::vector<std::optional<Eigen::Isometry3d>> truth_at(const std::vector<sensing::TimedPose>& truth,
                                                       const std::vector<std::int64_t>& times,
                                                       const Eigen::Isometry3d& T_imu_body) {
  std::vector<std::optional<Eigen::Isometry3d>> result;
  constexpr std::int64_t kMostApart = 500'000'000;
  for (const std::int64_t time : times) {
    result.emplace_back();
    const auto next = std::lower_bound(
        truth.begin(), truth.end(), time,
        [](const sensing::TimedPose& p, std::int64_t t) { return p.timestamp_ns < t; });
    if (next == truth.end()) continue;
    if (next->timestamp_ns == time) {
      result.back() = next->T_world_imu * T_imu_body;
      continue;
    }
    if (next == truth.begin()) continue;
    const auto before = std::prev(next);
    if (next->timestamp_ns - before->timestamp_ns > kMostApart) continue;
    const double share = static_cast<double>(time - before->timestamp_ns) /
                         static_cast<double>(next->timestamp_ns - before->timestamp_ns);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(before->T_world_imu.linear())
                        .slerp(share, Eigen::Quaterniond(next->T_world_imu.linear()))
                        .toRotationMatrix();
    pose.translation() =
        (1 - share) * before->T_world_imu.translation() + share * next->T_world_imu.translation();
    result.back() = pose * T_imu_body;
  }
  return result;
}

Compared compare(const io::Trajectory& poses,
                 const std::vector<std::optional<Eigen::Isometry3d>>& truth) {
  Compared compared;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!truth[i]) continue;
    compared.estimate.push_back(poses[i]);
    compared.truth.push_back(*truth[i]);
  }
  if (compared.truth.size() < 2) return compared;
  compared.error = io::trajectory_error(compared.estimate, compared.truth);
  compared.relative = io::relative_error(compared.estimate, compared.truth);
  return compared;
}

Json to_json(const LocalizeReport& report) {
  const fusion::EstimatorCounts& counts = report.drive.counts;
  Json json;
  json["tool"] = "partita";
  json["command"] = "localize";
  json["dataset"] = report.options.dataset.empty() ? "scenario" : report.options.dataset;
  json["kind"] = report.dataset.kind;
  json["begun"] = report.drive.origin;
  json["moments"] = report.drive.moments;
  json["states"] = report.drive.states.size();
  json["in_map"] = report.drive.in_map;
  json["body"] = report.dataset.frames ? "camera" : "imu";
  Json& vision = json["vision"];
  vision["frames"] = report.frames;
  vision["lost"] = report.frames_lost;
  vision["motions_used"] = counts.visual_used;
  vision["motions_rejected"] = counts.visual_rejected;
  vision["measured_seconds"] = report.vision_seconds;
  Json& imu = json["imu"];
  imu["readings"] = report.dataset.log.imu.size();
  imu["bridged_seconds"] = counts.bridged_seconds;
  imu["moments_at_rest"] = counts.standstill;
  const fusion::NavState& last = report.drive.states.back();
  const auto list = [](const Eigen::Vector3d& v) { return Json{v.x(), v.y(), v.z()}; };
  imu["gyro_bias_rad_s"] = list(last.bias.gyro);
  imu["accel_bias_m_s2"] = list(last.bias.accel);
  Json& gps = json["gps"];
  gps["fixes"] = report.dataset.log.gps.size();
  gps["used"] = counts.fixes_used;
  gps["rejected"] = counts.fixes_rejected;
  gps["before_the_map"] = counts.fixes_waiting;
  gps["relocations"] = counts.relocations;
  gps["longest_gap_seconds"] = counts.longest_gps_gap;
  json["unsolved"] = counts.unsolved;
  json["fusion_measured_seconds"] = report.fusion_seconds;
  if (report.fused.error) json["accuracy"] = to_json(report.fused);
  if (report.vision.error) json["accuracy_of_vision_alone"] = to_json(report.vision);
  if (!report.gaps.empty()) {
    const GapSummary s = summary(report.gaps);
    Json& test = json["gap_test"];
    test["seconds"] = report.options.gap_test;
    test["gaps"] = report.gaps.size();
    test["median_m"] = s.median;
    test["p90_m"] = s.p90;
    test["worst_m"] = s.worst;
    test["within_10_m_percent"] = s.within_10;
  }
  json["files"] = report.files;
  return json;
}

std::string to_text(const LocalizeReport& report) {
  const fusion::EstimatorCounts& counts = report.drive.counts;
  const sensing::SensorLog& log = report.dataset.log;
  std::string text =
      fmt::format("{} of {}: {} of {} moments localized, begun {}{}\n",
                  report.options.dataset.empty() ? "scenario" : report.options.dataset,
                  report.dataset.kind, report.drive.states.size(), report.drive.moments,
                  report.drive.origin, report.drive.in_map ? ", in the map" : "");
  if (report.frames > 0) {
    text +=
        fmt::format("vision              {} frames, {} lost, {} motions used, {} rejected\n",
                    report.frames, report.frames_lost, counts.visual_used, counts.visual_rejected);
  }
  if (!log.imu.empty()) {
    text += fmt::format("inertial            {} readings, {:.2f} s bridged, {} moments at rest\n",
                        log.imu.size(), counts.bridged_seconds, counts.standstill);
  }
  if (!log.gps.empty()) {
    text += fmt::format(
        "GPS                 {} fixes: {} used, {} rejected, {} before the map was "
        "known; longest gap {:.1f} s, {} relocations\n",
        log.gps.size(), counts.fixes_used, counts.fixes_rejected, counts.fixes_waiting,
        counts.longest_gps_gap, counts.relocations);
  }
  if (report.fused.error) text += line("fused", report.fused);
  if (report.vision.error) text += line("vision alone", report.vision);
  if (!report.gaps.empty()) {
    const GapSummary s = summary(report.gaps);
    text += fmt::format(
        "gaps of {:g} s        {} cut: off by {:.1f} m (median), {:.1f} m (90 %), "
        "{:.1f} m (worst); {:.1f} % within 10 m\n",
        report.options.gap_test, report.gaps.size(), s.median, s.p90, s.worst, s.within_10);
  }
  text += fmt::format(
      "measured here       vision {:.1f} ms a frame, fusion {:.2f} ms a moment\n",
      report.frames > 0 ? 1e3 * report.vision_seconds / static_cast<double>(report.frames) : 0.0,
      1e3 * report.fusion_seconds / static_cast<double>(report.drive.moments));
  std::string files;
  for (const std::string& file : report.files) files += (files.empty() ? "" : ", ") + file;
  return text + fmt::format("written to {}: {}\n", report.options.out, files);
}

void write_fixes(const std::string& path, const LocalizeReport& report) {
  std::string text =
      "#timestamp_ns,east,north,up,sigma,expected_east,expected_north,expected_up,off_m,"
      "off_sigmas,gap_s,verdict,line\n";
  for (const fusion::FixReport& r : report.drive.fixes) {
    const bool known = r.verdict != fusion::FixReport::Verdict::waiting;
    fmt::format_to(std::back_inserter(text), "{},{:.3f},{:.3f},{:.3f},{:g},", r.fix.timestamp_ns,
                   r.fix.position.x(), r.fix.position.y(), r.fix.position.z(), r.fix.sigma);
    if (known) {
      fmt::format_to(std::back_inserter(text), "{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{:.3f},",
                     r.predicted.x(), r.predicted.y(), r.predicted.z(),
                     (r.predicted - r.fix.position).head<2>().norm(), r.sigmas, r.gap_seconds);
    } else {
      text += ",,,,,,";
    }
    fmt::format_to(std::back_inserter(text), "{},{}\n", to_string(r.verdict), r.fix.line);
  }
  io::write_file(path, text);
}

void write_path_plot(const std::string& folder, const LocalizeReport& report) {
  constexpr double kWidth = 1000, kHeight = 760, kLeft = 80, kTop = 70, kRight = 970, kBottom = 690;
  plot::Drawing drawing(kWidth, kHeight, "Path from above");
  // The truth's axes are its own: the path is laid over it by the rigid motion that fits best.
  Eigen::Isometry3d T_shown_world = Eigen::Isometry3d::Identity();
  const bool with_truth = report.fused.error.has_value();
  std::vector<Eigen::Vector3d> path, truth, fixes;
  if (with_truth) {
    std::vector<Eigen::Vector3d> from, onto;
    for (const auto& pose : report.fused.estimate) from.emplace_back(pose.translation());
    for (const auto& pose : report.fused.truth) onto.emplace_back(pose.translation());
    // Shown in the estimate's world, whose z axis points up.
    const Eigen::Isometry3d T_world_truth = io::align(onto, from);
    for (const auto& p : onto) truth.emplace_back(T_world_truth * p);
  }
  for (const auto& pose : report.poses) path.emplace_back(T_shown_world * pose.translation());
  if (report.drive.in_map) {
    for (const auto& r : report.drive.fixes) {
      if (r.verdict != fusion::FixReport::Verdict::rejected) fixes.push_back(r.fix.position);
    }
  }
  double x0 = path[0].x(), x1 = x0, y0 = path[0].y(), y1 = y0;
  for (const auto* points : {&path, &truth, &fixes}) {
    for (const auto& p : *points) {
      x0 = std::min(x0, p.x());
      x1 = std::max(x1, p.x());
      y0 = std::min(y0, p.y());
      y1 = std::max(y1, p.y());
    }
  }
  const double scale = std::min((kRight - kLeft) / std::max(x1 - x0, 0.1),
                                (kBottom - kTop) / std::max(y1 - y0, 0.1)) *
                       0.96;
  const auto at = [&](const Eigen::Vector3d& p) {
    return plot::Point{(kLeft + kRight) / 2 + (p.x() - (x0 + x1) / 2) * scale,
                       (kTop + kBottom) / 2 - (p.y() - (y0 + y1) / 2) * scale};
  };
  const double step = plot::nice_step((kRight - kLeft) / scale, 8);
  const double middle_x = (x0 + x1) / 2, half_x = (kRight - kLeft) / 2 / scale;
  for (double v = std::ceil((middle_x - half_x) / step) * step; v <= middle_x + half_x; v += step) {
    const double px = at({v, 0, 0}).x;
    drawing.add(plot::Line{{{px, kTop}, {px, kBottom}}, plot::kGrid});
    drawing.add(
        plot::Text{{px, kBottom + 20}, fmt::format("{:g}", v + 0.0), 13, plot::Anchor::middle});
  }
  const double middle_y = (y0 + y1) / 2, half_y = (kBottom - kTop) / 2 / scale;
  for (double v = std::ceil((middle_y - half_y) / step) * step; v <= middle_y + half_y; v += step) {
    const double py = at({0, v, 0}).y;
    drawing.add(plot::Line{{{kLeft, py}, {kRight, py}}, plot::kGrid});
    drawing.add(
        plot::Text{{kLeft - 8, py + 5}, fmt::format("{:g}", v + 0.0), 13, plot::Anchor::end});
  }
  const auto line_of = [&](const std::vector<Eigen::Vector3d>& points, plot::Rgb colour,
                           double width) {
    plot::Line line{{}, colour, width};
    for (const auto& p : points) line.points.push_back(at(p));
    if (line.points.size() > 1) drawing.add(line);
  };
  for (const auto& p : fixes) {
    drawing.add(
        plot::Mark{.at = at(p), .radius = 2.5, .fill = plot::lighter(plot::series(1), 0.4)});
  }
  line_of(truth, plot::kLight, 6);
  line_of(path, plot::series(0), 2);
  drawing.add(
      plot::Text{{kLeft, 32},
                 fmt::format("Path from above: {}",
                             report.options.dataset.empty() ? "scenario" : report.options.dataset),
                 18,
                 plot::Anchor::start,
                 plot::kInk,
                 true});
  std::string legend = "estimate (blue)";
  if (with_truth) legend += ", truth (grey, aligned)";
  if (!fixes.empty()) legend += ", GPS fixes (dots)";
  if (report.fused.error) {
    legend += fmt::format("; ATE {:.3f} m over {:.1f} m", report.fused.error->ate_rmse,
                          report.fused.error->distance);
  }
  drawing.add(plot::Text{{kLeft, 54}, legend, 14, plot::Anchor::start, plot::kGrey});
  drawing.add(plot::Text{{(kLeft + kRight) / 2, kBottom + 46},
                         report.drive.in_map ? "metres east (up: north)" : "metres",
                         15,
                         plot::Anchor::middle});
  drawing.write(folder, "path");
}

}  // namespace partita::app
