// partita detect: objects in pictures, by a Darknet network on an OpenCL device.
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/detect.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/packager.h"
#include "host/app/stop.h"
#include "host/app/wall_clock.h"
#include "host/io/darknet.h"
#include "host/io/image.h"
#include "host/io/json_file.h"
#include "host/io/labels.h"
#include "host/io/output_folder.h"
#include "host/runtime/device.h"
#include "host/tasks/detection/detector.h"
#include "host/tasks/detection/kernels.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;
using detection::Detection;

/// Average precision asks for detections of every score; below this one they no longer matter.
constexpr float kLeastScore = 0.005F;

struct DetectOptions {
  std::string model, weights, names;
  std::vector<std::string> pictures;
  std::string out, draw, truth;
  std::string fit = "letterbox";
  std::string difficulty = "moderate";
  double threshold = 0.25;
  double overlap = 0.45;
  std::string machine = kNativeMachine;
  std::string device, container;
};

const std::map<std::string, Difficulty>& difficulties() {
  static const std::map<std::string, Difficulty> all{{"easy", Difficulty::easy},
                                                     {"moderate", Difficulty::moderate},
                                                     {"hard", Difficulty::hard},
                                                     {"all", Difficulty::all}};
  return all;
}

int classes_of(const io::darknet::Model& model) {
  int classes = 0;
  for (const io::darknet::Layer& layer : model.layers) {
    if (layer.kind != io::darknet::LayerKind::yolo) continue;
    if (classes != 0 && layer.yolo.classes != classes) {
      throw Error(fmt::format("{}:{}: {} classes, expected the {} of the first [yolo] layer",
                              model.path, layer.line, layer.yolo.classes, classes));
    }
    classes = layer.yolo.classes;
  }
  if (classes == 0)
    throw Error(fmt::format("{}: no [yolo] layer, so nothing to detect", model.path));
  return classes;
}

/// --names, else NAME.names or the one .names file beside NAME.cfg, else "class 0" and so on.
std::vector<std::string> class_names(const DetectOptions& options, int classes) {
  std::string file = options.names;
  if (file.empty()) {
    const fs::path own = fs::path(options.model).replace_extension(".names");
    std::set<fs::path> others;
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(fs::absolute(own).parent_path(), code)) {
      if (entry.path().extension() == ".names") others.insert(entry.path());
    }
    if (fs::exists(own)) file = own.string();
    if (file.empty() && others.size() == 1) file = others.begin()->string();
  }
  if (file.empty()) {
    std::vector<std::string> names;
    for (int c = 0; c < classes; ++c) names.push_back(fmt::format("class {}", c));
    return names;
  }
  std::vector<std::string> names = io::read_names(file);
  if (names.size() != static_cast<std::size_t>(classes)) {
    throw Error(fmt::format("{}: {} names, expected one for each of the network's {} classes", file,
                            names.size(), classes));
  }
  return names;
}

class Detect {
 public:
  Detect(const DetectOptions& options, const Console& console)
      : options_(options), console_(console) {}

  int run() {
    io::darknet::Model model = io::darknet::read_cfg(options_.model);
    names_ = class_names(options_, classes_of(model));
    const io::darknet::Weights weights = io::darknet::read_weights(options_.weights, model);
    for (const std::string& picture : options_.pictures) io::check_picture(picture);
    std::vector<detection::Truth> truths;
    if (!options_.truth.empty()) {
      truths = read_truth(options_.truth, options_.pictures, names_,
                          difficulties().at(options_.difficulty));
    }
    const runtime::Session session = open_session();
    detection::Detector detector(session, std::move(model), weights, detector_options());
    detector.warm_up();
    session.save_binaries();
    detect_all(detector);
    Json document = coco_results(kept_, names_);
    if (!options_.out.empty()) output([&] { io::write_json(options_.out, document); });
    report(std::move(document), truths, detector, session);
    return exit_ok;
  }

 private:
  runtime::Session open_session() {
    set_emulation({.machine = options_.machine});
    const std::vector<runtime::Device> devices = runtime::find_devices();
    if (devices.empty()) throw DeviceError("detect: no OpenCL device");
    const runtime::Device device = options_.device.empty()
                                       ? devices.front()
                                       : runtime::select_device(devices, options_.device);
    runtime::SessionOptions session;
    // An emulated device runs the CPU's text, which is proven to give the same bytes.
    session.execute = device.emulated() && options_.container.empty() ? runtime::Execute::fast
                                                                      : runtime::Execute::own;
    if (!device.accepts_source) {
      session.container = container_for(device, options_.machine, session.execute,
                                        options_.container, detection::kernel_specs());
    }
    return {device, detection::kernel_specs(), session};
  }

  detection::DetectorOptions detector_options() const {
    const auto threshold = static_cast<float>(options_.threshold);
    return {.fit = options_.fit == "stretch" ? detection::Fit::stretch : detection::Fit::letterbox,
            .threshold = options_.truth.empty() ? threshold : std::min(threshold, kLeastScore),
            .overlap = options_.overlap};
  }

  void detect_all(detection::Detector& detector) {
    ProgressBar bar(console_, "detecting", options_.pictures.size());
    catch_stop_signals();
    std::optional<io::OutputFolder> folder;
    if (!options_.draw.empty()) {
      output([&] { folder.emplace(options_.draw, "partita detect"); });
    }
    for (const std::string& path : options_.pictures) {
      if (stop_requested()) throw Interrupted();
      sensing::ColourImage picture = io::read_colour(path);
      const std::uint64_t begin = wall_now();
      found_.push_back(detector.detect(picture));
      picture_ns_.push_back(static_cast<double>(wall_now() - begin));
      keep(path, picture);
      if (folder) {
        draw_detections(picture, kept_.back().detections, names_);
        const std::string name =
            fmt::format("{:04}_{}.png", kept_.size() - 1, fs::path(path).stem().string());
        output([&] { io::write_colour(folder->file(name), picture); });
      }
      bar.update(kept_.size());
    }
    if (folder) folder->complete();
  }

  /// What the user asked for; what average precision asks for stays in found_.
  void keep(const std::string& path, const sensing::ColourImage& picture) {
    DetectedPicture kept{path, picture.width, picture.height, found_.back()};
    std::erase_if(kept.detections, [&](const Detection& d) {
      return !(d.score > static_cast<float>(options_.threshold));
    });
    for (Detection& d : found_.back()) {
      d.box = detection::clipped(d.box, picture.width, picture.height);
    }
    kept_.push_back(std::move(kept));
  }

  std::string detection_table() const {
    constexpr std::size_t kMost = 40;
    Table table({"picture", "class", "score", "left", "top", "width", "height"});
    std::size_t count = 0;
    for (const DetectedPicture& picture : kept_) {
      for (const Detection& d : picture.detections) {
        if (++count > kMost) continue;
        table.add({fs::path(picture.path).filename().string(),
                   names_[static_cast<std::size_t>(d.object_class)], fmt::format("{:.3f}", d.score),
                   fmt::format("{:.1f}", d.box.left), fmt::format("{:.1f}", d.box.top),
                   fmt::format("{:.1f}", d.box.width()), fmt::format("{:.1f}", d.box.height())});
      }
    }
    std::string text = table.empty() ? "" : table.to_string(console_.colour());
    if (count > kMost) text += fmt::format("... and {} more\n", count - kMost);
    return text + fmt::format("{} object{} in {} picture{}", count, count == 1 ? "" : "s",
                              kept_.size(), kept_.size() == 1 ? "" : "s");
  }

  void report(Json detections, const std::vector<detection::Truth>& truths,
              const detection::Detector& detector, const runtime::Session& session) {
    std::vector<double> sorted = picture_ns_;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double median_ns = sorted[sorted.size() / 2];
    std::string text = detection_table();
    text += fmt::format("; {} a picture (median, measured) on {}\n", format_ns(median_ns),
                        session.device().name);
    Json document;
    document["model"] = options_.model;
    document["pictures"] = options_.pictures;
    document["device"] = session.device().name;
    document["measured"] = {{"picture_median_ms", median_ns * 1e-6}};
    document["memory"] = {{"activation_bytes", detector.network().activation_bytes()},
                          {"weight_bytes", detector.network().weight_bytes()}};
    document["detections"] = std::move(detections);
    if (!truths.empty()) {
      const detection::Precision precision =
          detection::evaluate(found_, truths, static_cast<int>(names_.size()));
      if (precision.classes_with_objects == 0) {
        throw Error(fmt::format("{}: no object that counts in these pictures", options_.truth));
      }
      document["precision"] = precision_json(precision, names_);
      text += fmt::format("\nagainst {}{}\n{}", options_.truth,
                          fs::is_directory(options_.truth)
                              ? fmt::format(" (difficulty {})", options_.difficulty)
                              : "",
                          precision_table(precision, names_).to_string(console_.colour()));
    }
    console_.result(text, document);
  }

  const DetectOptions& options_;
  const Console& console_;
  std::vector<std::string> names_;
  std::vector<DetectedPicture> kept_;
  std::vector<std::vector<Detection>> found_;
  std::vector<double> picture_ns_;
};

}  // namespace

void add_detect(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "detect", "Find objects in pictures with a Darknet network (YOLO)",
      "partita detect --model yolo.cfg --weights yolo.weights street.png -o detections.json\n"
      "partita detect --model yolo.cfg --weights yolo.weights *.jpg --draw boxes --threshold 0.4\n"
      "partita detect --model yolo.cfg --weights yolo.weights street/image_0/*.png --truth street");
  auto options = std::make_shared<DetectOptions>();
  command->add_option("--model", options->model, "Network: Darknet's .cfg")->required();
  command->add_option("--weights", options->weights, "Its numbers: Darknet's .weights")->required();
  command->add_option("images", options->pictures, "Pictures: PNG, JPEG, PGM or PPM")->required();
  command->add_option("-o,--out", options->out,
                      "File for the detections, in COCO's results format");
  command->add_option("--names", options->names,
                      "Names of the classes, one for each line; default: the .names file beside "
                      "the model");
  command->add_option("--fit", options->fit, "How a picture is fitted into the network's input")
      ->check(CLI::IsMember({"letterbox", "stretch"}))
      ->capture_default_str();
  command->add_option("--threshold", options->threshold, "Least score, 0 to 1")
      ->check(number_range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--nms", options->overlap,
                   "Largest overlap (IoU) of two objects of one class, 0 to 1")
      ->check(number_range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--draw", options->draw, "Folder for pictures with boxes and names");
  command->add_option("--truth", options->truth,
                      "What there is to find, for average precision: COCO's annotations (.json) or "
                      "a folder with KITTI's labels");
  command->add_option("--difficulty", options->difficulty, "Which of KITTI's objects count")
      ->check(CLI::IsMember({"easy", "moderate", "hard", "all"}))
      ->capture_default_str();
  add_machine_option(command, options->machine);
  command->add_option("-d,--device", options->device,
                      "Device: cpu, gpu, fpga or a part of its name; default: the first one");
  add_container_option(command, options->container);
  command->callback([options, &context] {
    context.action = [options, &context] { return Detect(*options, context.console).run(); };
  });
}

}  // namespace partita::app
