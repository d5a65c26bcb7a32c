// partita depth: the disparity map of one stereo pair.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/depth_output.h"
#include "host/app/depth_report.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/packager.h"
#include "host/app/wall_clock.h"
#include "host/io/image.h"
#include "host/io/truth.h"
#include "host/tasks/depth/kernels.h"
#include "host/tasks/depth/point_cloud.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;

struct DepthOptions {
  std::string left, right;
  std::string out, colour, cloud;
  std::string machine = kNativeMachine, device, container, execute;
  std::string setting = std::string(depth::kSettings.front());
  int max_disparity = 0;  ///< 0: as the setting says
  std::vector<std::string> assignments;
  std::string truth, mask;
  double truth_scale = 0;  ///< 0: by the file
  std::string calibration;
  double focal = 0, baseline = 0;  ///< 0: not given
  std::optional<double> cx, cy;
  int repeat = 1;
  bool parameters = false;
};

/// Two names of one file come out equal, as far as the system lets one look.
fs::path resolved(const std::string& name) {
  std::error_code code;
  const fs::path path = fs::weakly_canonical(name, code);
  return code ? fs::path(name).lexically_normal() : path;
}

/// Names that cannot be meant are refused before anything is computed.
void check_outputs(const DepthOptions& options) {
  if (!options.out.empty() && !io::is_disparity_name(options.out)) {
    throw UsageError(
        fmt::format("depth: --out '{}', expected a name that ends in .png or .pfm", options.out));
  }
  const auto check_ending = [](const char* option, const std::string& name, const char* ending) {
    if (name.empty() || fs::path(name).extension() == ending) return;
    throw UsageError(
        fmt::format("depth: {} '{}', expected a name that ends in {}", option, name, ending));
  };
  check_ending("--colour", options.colour, ".png");
  check_ending("--cloud", options.cloud, ".ply");
  std::vector<std::pair<std::string, fs::path>> taken;
  for (const std::string* input :
       {&options.left, &options.right, &options.truth, &options.mask, &options.calibration}) {
    if (!input->empty()) taken.emplace_back(*input, resolved(*input));
  }
  for (const std::string* name : {&options.out, &options.colour, &options.cloud}) {
    if (name->empty()) continue;
    const fs::path path = resolved(*name);
    for (const auto& [other, other_path] : taken) {
      if (path != other_path) continue;
      throw UsageError(
          fmt::format("depth: '{}' would replace '{}', expected another name", *name, other));
    }
    taken.emplace_back(*name, path);
  }
}

depth::DepthParameters wanted_parameters(const DepthOptions& options, int width) {
  depth::DepthParameters parameters = depth::setting(options.setting);
  parameters.max_disparity = std::min(parameters.max_disparity, width - 1);
  for (const std::string& assignment : options.assignments) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) {
      throw UsageError(fmt::format("depth: --set '{}', expected name=value", assignment));
    }
    try {
      depth::set_parameter(parameters, assignment.substr(0, equals), assignment.substr(equals + 1));
    } catch (const Error& error) {
      throw UsageError(error.what());
    }
  }
  if (options.max_disparity > 0) parameters.max_disparity = options.max_disparity;
  return parameters;
}

/// KITTI's colour cameras are 2 and 3, and its folders say so.
int left_camera(const std::string& picture) {
  const std::string folder = fs::absolute(picture).parent_path().filename().string();
  return folder == "image_2" || folder == "image_02" ? 2 : 0;
}

sensing::PairCalibration wanted_calibration(const DepthOptions& options,
                                            const sensing::GrayImage& picture) {
  if (options.calibration.empty()) {
    sensing::PairCalibration calibration;
    calibration.camera = {.fx = options.focal,
                          .fy = options.focal,
                          .cx = options.cx.value_or((picture.width - 1) / 2.0),
                          .cy = options.cy.value_or((picture.height - 1) / 2.0),
                          .baseline = options.baseline,
                          .width = picture.width,
                          .height = picture.height};
    return calibration;
  }
  sensing::PairCalibration calibration =
      sensing::read_stereo_calibration(options.calibration, left_camera(options.left));
  const sensing::StereoCalibration& camera = calibration.camera;
  if (camera.width != 0 && (camera.width != picture.width || camera.height != picture.height)) {
    throw Error(fmt::format("{}: of pictures of {} x {}, but {} is {} x {}", options.calibration,
                            camera.width, camera.height, options.left, picture.width,
                            picture.height));
  }
  return calibration;
}

void check_calibration(const DepthOptions& options) {
  const bool numbers = options.focal > 0 || options.baseline > 0 || options.cx || options.cy;
  if (options.cloud.empty()) {
    if (!numbers && options.calibration.empty()) return;
    throw UsageError("depth: a calibration without --cloud, expected both or neither");
  }
  if (numbers && !options.calibration.empty()) {
    throw UsageError("depth: --calib and numbers of its own, expected one of them");
  }
  if (options.calibration.empty() && !(options.focal > 0 && options.baseline > 0)) {
    throw UsageError("depth: --cloud needs --calib, or --focal and --baseline");
  }
}

/// The named device; else the CPU of this computer, or of an emulated machine what `partita run`
/// would take for the scene.
runtime::Device wanted_device(const DepthOptions& options) {
  const std::vector<runtime::Device> devices = runtime::find_devices();
  if (!options.device.empty()) return runtime::select_device(devices, options.device);
  const bool native = options.machine == kNativeMachine;
  for (const char* kind : {native ? "cpu" : "gpu", native ? "gpu" : "cpu"}) {
    for (const runtime::Device& device : devices) {
      if (runtime::kind_of(device) == kind) return device;
    }
  }
  return devices.front();
}

class DepthCommand {
 public:
  DepthCommand(const DepthOptions& options, const Console& console)
      : options_(options), console_(console) {}

  int run() {
    if (options_.left.empty() || options_.right.empty()) {
      throw UsageError("depth: expected two pictures, left and right (see partita depth --help)");
    }
    check_outputs(options_);
    check_calibration(options_);
    if (options_.truth.empty() && (!options_.mask.empty() || options_.truth_scale > 0)) {
      throw UsageError("depth: --mask and --truth-scale need --truth");
    }
    const StereoPair pair = read_pair(options_.left, options_.right);
    for (const std::string& conversion : pair.conversions) console_.notice(conversion);
    const depth::DepthParameters parameters = wanted_parameters(options_, pair.left.width);
    std::optional<sensing::PairCalibration> calibration;
    if (!options_.cloud.empty()) calibration = wanted_calibration(options_, pair.left);
    read_truth(pair);

    set_emulation({.machine = options_.machine});
    const runtime::Device device = wanted_device(options_);
    const runtime::Session session(device, depth::kernel_specs(), session_options(device));
    session.extension().bind_thread("depth", 0, device);
    depth::Depth depth(session, pair.left.width, pair.left.height, parameters);
    depth.warm_up();
    session.save_binaries();
    std::vector<double> times_ms;
    std::optional<double> predicted_ms;
    depth::DisparityMap map;
    for (int i = 0; i < options_.repeat; ++i) {
      const std::uint64_t start = wall_now();
      const std::uint64_t virtual_start = session.extension().host_clock();
      map = depth.process(pair.left, pair.right, i);
      times_ms.push_back(static_cast<double>(wall_now() - start) * 1e-6);
      if (!session.extension().present()) continue;
      predicted_ms = static_cast<double>(session.extension().host_clock() - virtual_start) * 1e-6;
    }

    DepthReport report{.pair = pair,
                       .session = session,
                       .map = map,
                       .machine = options_.machine,
                       .setting = options_.setting,
                       .parameters = parameters,
                       .times_ms = times_ms,
                       .predicted_ms = predicted_ms};
    finish(report, calibration, depth);
    return exit_ok;
  }

 private:
  void read_truth(const StereoPair& pair) {
    if (options_.truth.empty()) return;
    truth_ = io::read_truth(options_.truth, options_.truth_scale > 0
                                                ? std::optional(options_.truth_scale)
                                                : std::nullopt);
    check_size(options_.truth, truth_->disparity, pair);
    if (options_.mask.empty()) return;
    mask_ = io::read_mask(options_.mask);
    check_size(options_.mask, *mask_, pair);
  }

  template <class T>
  static void check_size(const std::string& path, const sensing::Image<T>& image,
                         const StereoPair& pair) {
    if (image.width == pair.left.width && image.height == pair.left.height) return;
    throw Error(fmt::format("{}: {} x {}, expected {} x {} as {}", path, image.width, image.height,
                            pair.left.width, pair.left.height, pair.left_path));
  }

  runtime::SessionOptions session_options(const runtime::Device& device) const {
    const bool own = options_.execute.empty() ? !device.emulated() || !options_.container.empty()
                                              : options_.execute == "own";
    runtime::SessionOptions session;
    session.execute = own ? runtime::Execute::own : runtime::Execute::fast;
    if (!device.accepts_source) {
      session.container =
          container_for(device, options_.machine, session.execute, options_.container);
    }
    return session;
  }

  void finish(DepthReport& report, const std::optional<sensing::PairCalibration>& calibration,
              depth::Depth& depth) const {
    const StereoPair& pair = report.pair;
    report.warnings = doubts(pair, report.map, report.parameters, depth);
    const sensing::FloatImage disparity = to_pixels(report.map);
    if (truth_) {
      report.truth_path = options_.truth;
      report.truth_format = truth_->format;
      report.mask_path = options_.mask;
      report.evaluation = depth::evaluate(disparity, truth_->disparity, mask_ ? &*mask_ : nullptr);
      if (report.evaluation->with_truth == 0) {
        report.warnings.push_back(
            fmt::format("{}: no pixel with truth within the mask", options_.mask));
      }
    }
    output([&] { write(report, disparity, calibration); });
    for (const std::string& warning : report.warnings) console_.notice("warning: " + warning);
    console_.result(to_text(report), to_json(report));
  }

  void write(DepthReport& report, const sensing::FloatImage& disparity,
             const std::optional<sensing::PairCalibration>& calibration) const {
    if (!options_.out.empty()) {
      io::write_disparity_as(options_.out, disparity);
      report.files.push_back(options_.out);
    }
    if (!options_.colour.empty()) {
      const float most = *std::max_element(disparity.pixels.begin(), disparity.pixels.end());
      io::write_disparity_picture(options_.colour, disparity, std::max(1.0F, std::ceil(most)));
      report.files.push_back(options_.colour);
    }
    if (calibration) {
      const depth::PointCloud cloud = depth::point_cloud(disparity, report.pair.left, *calibration);
      if (cloud.too_far > 0) {
        report.warnings.push_back(
            fmt::format("{}: {} pixels of less than {} px of disparity left "
                        "out",
                        options_.cloud, cloud.too_far, depth::kLeastCloudDisparity));
      }
      io::write_ply(options_.cloud, cloud.points,
                    "left camera's axes (x right, y down, z forward), metres");
      report.files.push_back(options_.cloud);
    }
  }

  const DepthOptions& options_;
  const Console& console_;
  std::optional<io::Truth> truth_;
  std::optional<sensing::GrayImage> mask_;
};

void add_output_options(CLI::App* command, DepthOptions& options) {
  command->add_option("-o,--out", options.out,
                      "Disparity map: .png (16 bit, pixels x 256, 0: none) or .pfm (floats, "
                      "infinity: none)");
  command->add_option("--colour,--color", options.colour, "The map as a .png for people");
  command->add_option("--cloud", options.cloud, "Points in space as a .ply; needs a calibration");
  command->add_option("--calib", options.calibration,
                      "Calibration: KITTI's calib.txt or Middlebury's");
  command->add_option("--focal", options.focal, "Focal length instead, px")
      ->check(number_range(1, 1e6));
  command->add_option("--baseline", options.baseline, "Distance of the cameras, metres")
      ->check(number_range(1e-4, 1e4));
  command->add_option("--cx", options.cx, "Optical axis, px (default: the picture's centre)")
      ->check(number_range(-1e6, 1e6));
  command->add_option("--cy", options.cy, "Likewise")->check(number_range(-1e6, 1e6));
}

void add_matching_options(CLI::App* command, DepthOptions& options) {
  command->add_option("-s,--setting", options.setting, "Parameters that go together")
      ->check(CLI::IsMember({"robotics", "middlebury"}))
      ->capture_default_str();
  command
      ->add_option("--max-disparity", options.max_disparity,
                   "Largest disparity searched, px (default: 127, less for narrow pictures)")
      ->check(CLI::Range(1, 4096));
  command->add_option("--set", options.assignments, "Another parameter, name=value; repeatable")
      ->allow_extra_args(false);
  command->add_option("--repeat", options.repeat, "Match this often, and tell the median time")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--parameters", options.parameters,
                    "List all parameters with range and meaning instead");
  command->add_option("--truth", options.truth,
                      "True disparities: .pfm, or .png of 16 bits (KITTI) or 8 (Middlebury)");
  command
      ->add_option("--truth-scale", options.truth_scale,
                   "Levels of the truth's picture per pixel of disparity (default: 256 for 16 "
                   "bits, by info.txt beside it for 8)")
      ->check(number_range(1e-3, 65535));
  command->add_option("--mask", options.mask, "Picture that is white where truth counts");
}

}  // namespace

void add_depth(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "depth", "Disparity map of one stereo pair, and how good it is",
      "partita depth left.png right.png -o disparity.png --colour view.png\n"
      "partita depth im0.png im1.png --cloud points.ply --calib calib.txt\n"
      "partita depth imL.png imR.png --truth groundtruth.png --setting middlebury --json\n"
      "partita depth left.png right.png --machine tx2 --device gpu --set lr_threshold=1\n"
      "partita depth --parameters");
  auto options = std::make_shared<DepthOptions>();
  command->add_option("LEFT", options->left, "Rectified picture of the left camera");
  command->add_option("RIGHT", options->right, "Of the right one");
  add_output_options(command, *options);
  add_matching_options(command, *options);
  add_machine_option(command, options->machine);
  command->add_option("-d,--device", options->device, "cpu, gpu, fpga or a part of its name");
  add_container_option(command, options->container);
  command
      ->add_option("--execute", options->execute,
                   "Text that computes the results on an emulated device: own, or fast, the equal "
                   "CPU variant (default: fast; native: own)")
      ->check(CLI::IsMember({"own", "fast"}));
  command->callback([options, &context] {
    context.action = [options, &context] {
      if (!options->parameters) return DepthCommand(*options, context.console).run();
      context.console.result(parameters_text(context.console), parameters_json());
      return static_cast<int>(exit_ok);
    };
  });
}

}  // namespace partita::app
