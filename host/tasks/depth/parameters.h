// The parameters of ELAS, named as in the paper and in its authors' library; the two settings that
// people know from there; and a table of them all, for whoever sets them by name.
#ifndef PARTITA_HOST_TASKS_DEPTH_PARAMETERS_H
#define PARTITA_HOST_TASKS_DEPTH_PARAMETERS_H

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace partita::depth {

/// Meanings, units and ranges are in parameters(). The defaults are the "robotics" setting.
struct DepthParameters {
  int max_disparity = 127;
  int candidate_step = 5;
  double support_threshold = 0.85;
  int support_texture = 10;
  int incon_window = 5;
  int incon_threshold = 5;
  int incon_min_support = 5;
  int redun_max_distance = 5;
  int redun_threshold = 1;
  bool add_corners = false;
  int grid_size = 20;
  double beta = 0.02;
  double gamma = 3;
  double sigma = 1;
  double sradius = 2;
  int match_texture = 1;
  int lr_threshold = 2;
  int speckle_similarity = 1;
  int speckle_size = 200;
  int ipol_gap_width = 3;
  bool filter_adaptive_mean = true;
  bool filter_median = false;

  bool operator==(const DepthParameters&) const = default;
};

inline constexpr std::array<std::string_view, 2> kSettings{"robotics", "middlebury"};

/// "robotics": what can be trusted, with holes; "middlebury": a disparity for (nearly) every pixel,
/// for benchmarks. Throws Error that lists the settings there are.
DepthParameters setting(std::string_view name);

/// The "robotics" setting, with no more disparities than pictures of that width can have.
DepthParameters default_parameters(int width);

enum class ParameterKind { integer, real, flag };

struct Parameter {
  std::string_view name;
  std::string_view unit;  ///< "px", "grid steps", "grey levels", "sigma" …; empty for pure numbers
  ParameterKind kind = ParameterKind::integer;
  double least = 0;
  double most = 0;
  std::string_view meaning;
  double (*get)(const DepthParameters&) = nullptr;  ///< flags: 0 or 1
  void (*set)(DepthParameters&,
              double) = nullptr;  ///< the value is in range, and whole unless real
};

/// All parameters, in the order in which the algorithm uses them.
std::span<const Parameter> parameter_table();

/// Sets one parameter from text: a number, or on/off (true/false, 1/0) for a flag. Throws Error for
/// an unknown name (and lists those there are), for what is no such value, and for one out of
/// range.
void set_parameter(DepthParameters& parameters, std::string_view name, std::string_view value);

/// "5", "0.85", "on".
std::string value_text(const Parameter& parameter, const DepthParameters& parameters);

/// Throws Error for a parameter out of range, or for a pair of them that does not go together.
void check_parameters(const DepthParameters& parameters);

/// How far from its plane a pixel's disparity is tried, px: sigma * sradius, 2 at least.
int plane_radius(const DepthParameters& parameters);

}  // namespace partita::depth

#endif  // PARTITA_HOST_TASKS_DEPTH_PARAMETERS_H
