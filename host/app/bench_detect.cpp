// partita bench detect: how fast a Darknet network runs, as a whole and layer by layer.
#include <algorithm>

#include <fmt/format.h>

#include "host/app/bench.h"
#include "host/app/dnn_peer.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/roofline.h"
#include "host/app/wall_clock.h"
#include "host/tasks/detection/darknet_network.h"
#include "host/tasks/detection/kernels.h"

namespace partita::app {
namespace {

using detection::DarknetNetwork;
using detection::PlannedStep;
using detection::StepKernel;

struct DetectOptions {
  std::string model, weights;  ///< no weights: random ones
  std::string machine = kNativeMachine, device;
  int side = 0, rounds = 15;
  bool layers = false, peer = false;
};

/// Multiply-adds of a step, those of pixels computed twice left out.
double multiply_adds(const PlannedStep& step) {
  const auto& shape = step.shape;
  const auto of = [&](const char* name) { return static_cast<double>(shape[name]); };
  const double pixels = of("width") * of("height");
  if (step.kernel == StepKernel::convolution) {
    return pixels * of("outputs") * of("inputs") * of("size") * of("size");
  }
  if (step.kernel == StepKernel::depthwise)
    return pixels * of("channels") * of("size") * of("size");
  return 0;
}

double unique_bytes(const PlannedStep& step) {
  const Work work = detection::spec_of(step.kernel).work(runtime::Variant::cpu, step.shape);
  return static_cast<double>(work.unique());
}

std::string described(const PlannedStep& step) {
  const auto& in = step.in.extent;
  const auto& out = step.out.extent;
  std::string text = fmt::format("{}x{}x{} to {}x{}x{}", in.width, in.height, in.channels,
                                 out.width, out.height, out.channels);
  if (step.shape.has("size")) {
    text += fmt::format(", {}x{}", step.shape["size"], step.shape["size"]);
    if (step.shape["stride"] != 1) text += fmt::format(" / {}", step.shape["stride"]);
  }
  if (step.other) text += ", shortcut";
  return text;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double milliseconds_since(std::uint64_t start) {
  return static_cast<double>(wall_now() - start) * 1e-6;
}

Json layer_rows(const DarknetNetwork& network, const std::vector<double>& seconds,
                const Roofline& roof, Table& table) {
  Json rows = Json::array();
  const auto& steps = network.plan().steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double operations = 2 * multiply_adds(steps[i]), bytes = unique_bytes(steps[i]);
    const double rate = operations / seconds[i] * 1e-9;
    const double share = 100 * roof.seconds(operations, bytes) / seconds[i];
    const std::string& kernel = detection::spec_of(steps[i].kernel).name;
    table.add({std::to_string(steps[i].layer), kernel, described(steps[i]),
               fmt::format("{:.3f}", seconds[i] * 1e3), fmt::format("{:.1f}", rate),
               fmt::format("{:.0f} %", share)});
    rows.push_back({{"layer", steps[i].layer},
                    {"kernel", kernel},
                    {"shape", steps[i].shape.to_string()},
                    {"ms", seconds[i] * 1e3},
                    {"gflop_per_s", rate},
                    {"roofline_percent", share}});
  }
  return rows;
}

/// The network and OpenCV in turns, so that a change of the machine's load meets both.
Json measure_whole(DarknetNetwork& network, DnnPeer* peer, const std::vector<float>& picture,
                   int rounds, const Console& console) {
  std::vector<double> ours, theirs;
  ProgressBar bar(console, "bench detect", static_cast<std::size_t>(rounds));
  for (int round = 0; round < rounds; ++round) {
    std::uint64_t start = wall_now();
    network.run(picture);
    ours.push_back(milliseconds_since(start));
    if (peer != nullptr) {
      start = wall_now();
      peer->run(picture);
      theirs.push_back(milliseconds_since(start));
    }
    bar.update(static_cast<std::size_t>(round) + 1);
  }
  bar.clear();
  Json result{{"ms", median(ours)}, {"least_ms", *std::min_element(ours.begin(), ours.end())}};
  if (peer != nullptr) {
    result["opencv_ms"] = median(theirs);
    result["opencv_least_ms"] = *std::min_element(theirs.begin(), theirs.end());
    result["ratio"] = median(theirs) / median(ours);
  }
  return result;
}

io::darknet::Weights weights_of(const DetectOptions& options, const io::darknet::Model& model) {
  return options.weights.empty() ? io::darknet::random_weights(model, 1)
                                 : io::darknet::read_weights(options.weights, model);
}

int detect(const DetectOptions& options, const Console& console) {
  std::optional<int> side;
  if (options.side != 0) side = options.side;
  const io::darknet::Model model = io::darknet::read_cfg(options.model, side);
  const io::darknet::Weights weights = weights_of(options, model);
  set_emulation({.machine = options.machine});
  const auto devices = runtime::find_devices();
  const runtime::Device device =
      options.device.empty() ? devices.front() : runtime::select_device(devices, options.device);
  if (!device.accepts_source) {
    throw DeviceError(fmt::format("bench: {} takes no source", device.name));
  }
  std::uint64_t start = wall_now();
  const runtime::Session session(device, detection::kernel_specs(),
                                 {.variant = runtime::Variant::cpu});
  DarknetNetwork network(session, model, weights);
  network.warm_up();
  const double start_up = milliseconds_since(start);
  session.save_binaries();

  const std::vector<float> picture(model.input.count(), 0.5F);
  std::unique_ptr<DnnPeer> peer;
  if (options.peer) {
    peer = std::make_unique<DnnPeer>(options.model, model, weights);
    peer->run(picture);
  }
  Json document{{"model", model.path}, {"device", device.name}, {"rounds", options.rounds}};
  Json measured = measure_whole(network, peer.get(), picture, options.rounds, console);
  double operations = 0;
  for (const PlannedStep& step : network.plan().steps) operations += 2 * multiply_adds(step);
  const double rate = operations / measured["ms"].get<double>() * 1e-6;
  measured["gflop_per_s"] = rate;
  measured["start_up_ms"] = start_up;
  document["memory"] = {{"activation_bytes", network.activation_bytes()},
                        {"weight_bytes", network.weight_bytes()}};
  std::string text;
  if (options.layers) {
    const Roofline roof = measure_roofline(device);
    measured["peak_gflop_per_s"] = roof.flops * 1e-9;
    measured["copy_gb_per_s"] = roof.bandwidth * 1e-9;
    Table table({"layer", "kernel", "maps", "ms", "GFLOP/s", "roofline"});
    measured["layers"] = layer_rows(network, network.time_steps(picture, 5), roof, table);
    text = table.to_string(console.colour());
    text += fmt::format(
        "Roof: {:.1f} GFLOP/s and {:.1f} GB/s, a copy in main memory, measured "
        "here.\n",
        roof.flops * 1e-9, roof.bandwidth * 1e-9);
  }
  text += fmt::format(
      "{} at {}x{} on {}: {:.2f} ms, {:.1f} GFLOP/s (median of {}); {:.1f} MB of "
      "maps, {:.1f} MB of weights; start-up {:.2f} s\n",
      model.path, model.input.width, model.input.height, device.name, measured["ms"].get<double>(),
      rate, options.rounds, static_cast<double>(network.activation_bytes()) * 1e-6,
      static_cast<double>(network.weight_bytes()) * 1e-6, start_up * 1e-3);
  if (peer) {
    text += fmt::format(
        "OpenCV's dnn, {} threads, in turns with it: {:.2f} ms, {:.2f} times as "
        "long\n",
        peer->threads(), measured["opencv_ms"].get<double>(), measured["ratio"].get<double>());
  }
  document["measured"] = std::move(measured);
  console.result(text, document);
  return exit_ok;
}

}  // namespace

void add_bench_detect(CLI::App& bench, Context& context) {
  CLI::App* command = add_subcommand(
      bench, context, "detect", "Time of a Darknet network, layer by layer, beside OpenCV's",
      "partita bench detect --model yolov3-tiny.cfg --layers\n"
      "partita bench detect --model yolo-fastest.cfg --weights yolo-fastest.weights --peer");
  auto options = std::make_shared<DetectOptions>();
  command->add_option("--model", options->model, "The network, a .cfg")->required();
  command->add_option("--weights", options->weights, "Its .weights; without them, random ones");
  command->add_option("--side", options->side, "Side of the pictures, instead of the .cfg's")
      ->check(CLI::Range(32, 4096));
  add_machine_option(command, options->machine);
  command->add_option("--device", options->device, "cpu, gpu, or part of a device's name");
  command->add_option("--rounds", options->rounds, "Pictures to take the median of")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--layers", options->layers, "GFLOP/s and share of the roofline of each layer");
  command->add_flag("--peer", options->peer, "OpenCV's dnn in turns with it");
  command->callback([options, &context] {
    context.action = [options, &context] { return detect(*options, context.console); };
  });
}

}  // namespace partita::app
