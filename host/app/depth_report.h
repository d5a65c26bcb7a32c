// What `partita depth` found, for people and for scripts.
#ifndef PARTITA_HOST_APP_DEPTH_REPORT_H
#define PARTITA_HOST_APP_DEPTH_REPORT_H

#include <optional>
#include <string>
#include <vector>

#include "host/app/console.h"
#include "host/app/stereo_pair.h"
#include "host/runtime/session.h"
#include "host/tasks/depth/evaluation.h"
#include "host/tasks/depth/parameters.h"

namespace partita::app {

struct DepthReport {
  const StereoPair& pair;
  const runtime::Session& session;
  const depth::DisparityMap& map;
  std::string machine;
  std::string setting;
  depth::DepthParameters parameters;
  std::vector<double> times_ms;        ///< from pictures to map, both in host memory; at least one
  std::optional<double> predicted_ms;  ///< the same on the emulated device
  std::string truth_path, truth_format;  ///< empty without truth
  std::string mask_path;
  std::optional<depth::Evaluation> evaluation;
  std::vector<std::string> warnings;
  std::vector<std::string> files;
};

Json to_json(const DepthReport& report);
std::string to_text(const DepthReport& report);

/// All parameters with unit, range, meaning and their value in each setting.
Json parameters_json();
std::string parameters_text(const Console& console);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_DEPTH_REPORT_H
