// partita track: one object through a sequence of pictures.
#include <algorithm>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/packager.h"
#include "host/app/stop.h"
#include "host/app/wall_clock.h"
#include "host/io/boxes.h"
#include "host/io/file.h"
#include "host/io/image.h"
#include "host/io/output_folder.h"
#include "host/io/sequence.h"
#include "host/tasks/tracking/accuracy.h"
#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/tracker.h"

namespace partita::app {
namespace {

using tracking::Box;
using Boxes = std::vector<std::optional<Box>>;

struct TrackOptions {
  std::string machine = "dragonfly", device = "cpu", container;
  std::string sequence, truth, out, draw;
  std::vector<double> init;
  std::size_t frames = 0;  ///< 0: all
  int template_side = 64;
};

void draw(const std::string& path, const sensing::GrayImage& image, const Box& box,
          const std::optional<Box>& truth) {
  const cv::Mat gray(image.height, image.width, CV_8UC1,
                     const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  const auto rectangle = [&picture](const Box& b, const cv::Scalar& colour) {
    cv::rectangle(picture, cv::Rect2d(b.x, b.y, b.width, b.height), colour, 1);
  };
  if (truth) rectangle(*truth, {255, 255, 255});
  rectangle(box, {60, 200, 60});
  std::vector<unsigned char> bytes;
  cv::imencode(".png", picture, bytes);
  io::write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// The folder for --draw, which must be new, empty, or what an interrupted run of this left.
std::optional<io::OutputFolder> drawing_folder(const std::string& path) {
  if (path.empty()) return std::nullopt;
  std::error_code code;
  const bool occupied =
      std::filesystem::is_directory(path, code) && !std::filesystem::is_empty(path, code);
  if (occupied && !io::is_partial(path, io::kTrackWriter)) {
    throw OutputError(fmt::format("{}: is not empty; choose another folder for --draw", path));
  }
  return output(
      [&] { return std::optional<io::OutputFolder>(std::in_place, path, io::kTrackWriter); });
}

class SingleTrack {
 public:
  SingleTrack(const TrackOptions& options, const Console& console)
      : options_(options), console_(console) {}

  int run() {
    prepare();
    auto drawings = drawing_folder(options_.draw);
    set_emulation({.machine = options_.machine});
    const runtime::Device device = runtime::select_device(runtime::find_devices(), options_.device);
    runtime::SessionOptions session_options;
    if (!device.accepts_source) {
      session_options.container = container_for(device, options_.machine, runtime::Execute::own,
                                                options_.container, tracking::kernel_specs());
    }
    const runtime::Session session(device, tracking::kernel_specs(), session_options);
    tracking::TrackerParameters parameters;
    parameters.filter.template_side = options_.template_side;
    parameters.capacity = 1;
    tracking::Tracker tracker(session, image_.width, image_.height, parameters);
    tracker.warm_up();
    session.save_binaries();
    catch_stop_signals();
    follow(session, tracker, drawings);
    output([&] {
      io::write_boxes(options_.out, boxes_);
      if (drawings) drawings->complete();
    });
    report(device);
    if (!why_.empty()) {
      console_.error(fmt::format("{}: the target {}; the {} boxes before it are in {}",
                                 pictures_[boxes_.size()], why_, boxes_.size(), options_.out));
    }
    return why_.empty() ? exit_ok : exit_failure_found;
  }

 private:
  /// Whatever the user may have got wrong is told before anything is computed.
  void prepare() {
    pictures_ = io::list_pictures(options_.sequence);
    if (!options_.truth.empty()) {
      truth_ = io::read_boxes(options_.truth);
      if (truth_.size() != pictures_.size()) {
        throw Error(fmt::format("{}: {} boxes for the {} pictures of {}", options_.truth,
                                truth_.size(), pictures_.size(), options_.sequence));
      }
    }
    if (options_.frames > 0 && options_.frames < pictures_.size()) {
      pictures_.resize(options_.frames);
      truth_.resize(std::min(truth_.size(), options_.frames));
    }
    image_ = io::read_gray(pictures_.front()).image;
    std::string what = "--init";
    if (!options_.init.empty()) {
      init_ = {options_.init[0], options_.init[1], options_.init[2], options_.init[3]};
    } else if (!truth_.empty() && truth_.front()) {
      init_ = *truth_.front();
      what = options_.truth + ":1";
    } else {
      throw UsageError("track: neither --init nor a first box in --truth says what to track");
    }
    tracking::check_box(what, init_, image_.width, image_.height);
  }

  void follow(const runtime::Session& session, tracking::Tracker& tracker,
              const std::optional<io::OutputFolder>& drawings) {
    const tracking::Detection first{init_, 1, 0};
    ProgressBar bar(console_, "tracking", pictures_.size());
    for (std::size_t k = 0; k < pictures_.size() && why_.empty(); ++k) {
      if (stop_requested()) throw Interrupted();
      if (k > 0) read(k);
      const std::uint64_t begin = wall_now(), virtual_begin = session.extension().host_clock();
      tracker.update(image_, k == 0 ? std::optional(std::span(&first, 1)) : std::nullopt,
                     static_cast<std::int64_t>(k));
      if (k > 0) {
        measured_ns_.push_back(static_cast<double>(wall_now() - begin));
        predicted_ns_ += static_cast<double>(session.extension().host_clock() - virtual_begin);
      }
      if (tracker.tracks().empty()) {
        why_ = tracking::to_string(tracker.ended().front().why);
        break;
      }
      const Box box = tracker.tracks().front().box;
      boxes_.emplace_back(box);
      if (drawings) {
        output([&] {
          draw(drawings->file(fmt::format("{:06}.png", k)), image_, box,
               k < truth_.size() ? truth_[k] : std::nullopt);
        });
      }
      bar.update(k + 1);
    }
  }

  void read(std::size_t k) {
    sensing::GrayImage next = io::read_gray(pictures_[k]).image;
    if (next.width != image_.width || next.height != image_.height) {
      throw Error(fmt::format("{}: {} x {} pixels, expected {} x {} as in {}", pictures_[k],
                              next.width, next.height, image_.width, image_.height,
                              pictures_.front()));
    }
    image_ = std::move(next);
  }

  void report(const runtime::Device& device) {
    Json document;
    document["sequence"] = options_.sequence;
    document["boxes"] = options_.out;
    document["pictures"] = pictures_.size();
    document["tracked"] = boxes_.size();
    document["width"] = image_.width;
    document["height"] = image_.height;
    document["device"] = device.name;
    std::string text =
        fmt::format("{} of {} pictures, {}x{}, on {}; boxes in {}\n", boxes_.size(),
                    pictures_.size(), image_.width, image_.height, device.name, options_.out);
    if (!truth_.empty()) {
      const tracking::Accuracy accuracy = tracking::measure(boxes_, truth_);
      document["accuracy"] = {{"frames", accuracy.frames},
                              {"mean_iou", accuracy.mean_overlap},
                              {"precision_20px", accuracy.precision}};
      text += fmt::format("accuracy   mean IoU {:.3f}, precision at 20 px {:.3f}\n",
                          accuracy.mean_overlap, accuracy.precision);
    }
    if (!measured_ns_.empty()) {
      const auto middle =
          measured_ns_.begin() + static_cast<std::ptrdiff_t>(measured_ns_.size() / 2);
      std::nth_element(measured_ns_.begin(), middle, measured_ns_.end());
      document["measured"] = {{"median_frame_ms", *middle / 1e6}, {"frames_per_s", 1e9 / *middle}};
      text +=
          fmt::format("measured   {} a frame (median), {:.0f} frames/s, reading pictures aside\n",
                      format_ns(*middle), 1e9 / *middle);
      if (device.emulated()) {
        const double mean = predicted_ns_ / static_cast<double>(measured_ns_.size());
        document["predicted"] = {{"mean_frame_ms", mean / 1e6}};
        text +=
            fmt::format("predicted  {} a frame (mean) on {}\n", format_ns(mean), device.profile);
      }
    }
    if (!why_.empty()) document["ended"] = {{"picture", pictures_[boxes_.size()]}, {"why", why_}};
    console_.result(text, document);
  }

  const TrackOptions& options_;
  const Console& console_;
  std::vector<std::string> pictures_;
  Boxes truth_, boxes_;
  Box init_;
  sensing::GrayImage image_;
  std::vector<double> measured_ns_;
  double predicted_ns_ = 0;
  std::string why_;  ///< the target is gone; empty: it is not
};

}  // namespace

void add_track(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "track", "Follow one object through a sequence of pictures",
      "partita track --sequence Crossing --init 205,151,17,50 -o boxes.txt\n"
      "partita track --sequence Crossing --truth Crossing/groundtruth_rect.txt -o boxes.txt "
      "--draw pictures\n"
      "partita track --sequence street/image_0 --init 600,300,80,60 -o boxes.txt --device gpu");
  auto options = std::make_shared<TrackOptions>();
  command->add_option("-s,--sequence", options->sequence, "Folder of pictures, or with img/ in it")
      ->required();
  command
      ->add_option("--init", options->init, "Box in the first picture: x,y,width,height in pixels")
      ->delimiter(',')
      ->expected(4);
  command->add_option("-o,--out", options->out, "File for the boxes: a line x,y,w,h per picture")
      ->required();
  command->add_option("--truth", options->truth,
                      "True boxes, to measure against; the first one is tracked without --init");
  command->add_option("--draw", options->draw, "Folder for pictures with the box drawn in");
  command->add_option("--frames", options->frames, "Only the first so many pictures")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--template", options->template_side, "Side of the canonical template, px")
      ->check(CLI::IsMember({64, 128}))
      ->capture_default_str();
  command->add_option("-d,--device", options->device, "cpu, gpu, fpga or a part of a device's name")
      ->capture_default_str();
  add_machine_option(command, options->machine);
  add_container_option(command, options->container);
  command->callback([options, &context] {
    context.action = [options, &context] { return SingleTrack(*options, context.console).run(); };
  });
}

}  // namespace partita::app
