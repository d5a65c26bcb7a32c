#include "host/tasks/detection/detector.h"

#include <utility>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/host_step.h"
#include "host/tasks/detection/nms.h"
#include "host/tasks/detection/steps.h"

namespace partita::detection {

Detector::Detector(const runtime::Session& session, io::darknet::Model model,
                   const io::darknet::Weights& weights, const DetectorOptions& options)
    : session_(session), network_(session, std::move(model), weights), options_(options) {
  if (const io::darknet::Model& m = network_.model(); m.input.channels != 3) {
    throw Error(fmt::format("{}: takes pictures of {} channels, expected 3: red, green, blue",
                            m.path, m.input.channels));
  }
}

std::vector<Detection> Detector::detect(const sensing::ColourImage& picture) {
  const io::darknet::Model& model = network_.model();
  const Placed placed =
      place(picture.width, picture.height, model.input.width, model.input.height, options_.fit);
  fit_picture(picture, placed, input_);
  runtime::declare_host_step(session_, fit_spec(),
                             {{"pixels", std::int64_t{model.input.width} * model.input.height}});

  const std::vector<RawOutput>& outputs = network_.run(input_);
  std::vector<Detection> candidates = decode(model, outputs, placed, options_.threshold);
  std::int64_t anchors = 0;
  std::int64_t classes = 0;
  for (const RawOutput& o : outputs) {
    const io::darknet::Yolo& yolo = model.layers[o.layer].yolo;
    anchors += std::int64_t{o.width} * o.height * static_cast<std::int64_t>(yolo.mask.size());
    classes = yolo.classes;
  }
  const auto found = static_cast<std::int64_t>(candidates.size());
  Suppressed result = suppress(std::move(candidates), options_.overlap);
  runtime::declare_host_step(session_, boxes_spec(),
                             {{"anchors", anchors},
                              {"classes", classes},
                              {"candidates", found},
                              {"compared", static_cast<std::int64_t>(result.compared)}});
  return std::move(result.kept);
}

}  // namespace partita::detection
