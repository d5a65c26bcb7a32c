// From sections to layers with shapes. Formulas and defaults are Darknet's.
#include <array>
#include <utility>

#include <fmt/format.h>

#include "host/io/darknet.h"
#include "host/io/darknet_sections.h"
#include "host/io/file.h"
#include "host/runtime/error.h"

namespace partita::io::darknet {
namespace {

constexpr int kLargestSide = 8192, kMostChannels = 65536, kLargestWindow = 63, kMostAnchors = 64;
constexpr std::int64_t kMostNumbers = std::int64_t{1} << 29;  // of one layer

constexpr std::array<std::pair<std::string_view, Activation>, 7> kActivations{
    {{"linear", Activation::linear},
     {"leaky", Activation::leaky},
     {"relu", Activation::relu},
     {"relu6", Activation::relu6},
     {"logistic", Activation::logistic},
     {"swish", Activation::swish},
     {"mish", Activation::mish}}};
constexpr std::array<std::pair<std::string_view, LayerKind>, 7> kKinds{
    {{"convolutional", LayerKind::convolutional},
     {"maxpool", LayerKind::maxpool},
     {"upsample", LayerKind::upsample},
     {"route", LayerKind::route},
     {"shortcut", LayerKind::shortcut},
     {"dropout", LayerKind::dropout},
     {"yolo", LayerKind::yolo}}};

std::string to_text(const Extent& e) {
  return fmt::format("{} x {} x {}", e.width, e.height, e.channels);
}

/// Reads sections in turn and knows the layers so far.
class Reader {
 public:
  explicit Reader(Model& model) : model_(model) {}

  void read(Section& section) {
    Layer layer;
    layer.kind = kind_of(section);
    layer.line = section.line();
    layer.inputs = {static_cast<int>(model_.layers.size()) - 1};
    layer.in = extent_of(layer.inputs[0]);
    switch (layer.kind) {
      case LayerKind::convolutional:
        convolutional(section, layer);
        break;
      case LayerKind::maxpool:
        maxpool(section, layer);
        break;
      case LayerKind::upsample:
        upsample(section, layer);
        break;
      case LayerKind::route:
        route(section, layer);
        break;
      case LayerKind::shortcut:
        shortcut(section, layer);
        break;
      case LayerKind::dropout:
        section.ignore({"probability", "dropblock", "dropblock_size_rel", "dropblock_size_abs"});
        layer.out = layer.in;
        break;
      case LayerKind::yolo:
        yolo(section, layer);
        break;
    }
    section.expect_all_read();
    const std::int64_t numbers = std::int64_t{layer.out.width} * layer.out.height;
    if (numbers * layer.out.channels > kMostNumbers) {
      section.fail(
          fmt::format("{} numbers, expected at most {}", to_text(layer.out), kMostNumbers));
    }
    model_.layers.push_back(std::move(layer));
  }

 private:
  static LayerKind kind_of(const Section& section) {
    for (const auto& [name, kind] : kKinds) {
      if (name == section.name()) return kind;
    }
    section.fail(
        "not a known layer, expected convolutional, maxpool, upsample, route, shortcut, dropout "
        "or yolo");
  }

  static Activation activation_of(Section& section, const char* otherwise) {
    const std::string word = section.word("activation", otherwise);
    for (const auto& [name, activation] : kActivations) {
      if (name == word) return activation;
    }
    section.fail("activation", "expected linear, leaky, relu, relu6, logistic, swish or mish");
  }

  const Extent& extent_of(int layer) const {
    return layer == kPicture ? model_.input : model_.layers[static_cast<std::size_t>(layer)].out;
  }

  static int side_after(Section& section, int side, const Layer& layer, int padding) {
    const int room = side + padding - layer.size;
    if (room < 0) {
      section.fail(
          fmt::format("a window of {} does not fit an input of {}", layer.size, to_text(layer.in)));
    }
    return room / layer.stride + 1;
  }

  void convolutional(Section& section, Layer& layer) const {
    const int filters = section.integer("filters", 1, 1, kMostChannels);
    layer.size = section.integer("size", 1, 1, kLargestWindow);
    layer.stride = section.integer("stride", 1, 1, kLargestWindow);
    layer.pad = section.integer("padding", 0, 0, kLargestWindow);
    if (section.integer("pad", 0, 0, 1) != 0) layer.pad = layer.size / 2;
    layer.groups = section.integer("groups", 1, 1, kMostChannels);
    layer.batch_normalize = section.integer("batch_normalize", 0, 0, 1) != 0;
    layer.activation = activation_of(section, "logistic");
    section.ignore({"stopbackward", "learning_rate"});
    if (layer.in.channels % layer.groups != 0 || filters % layer.groups != 0) {
      section.fail(fmt::format("{} groups divide neither or only one of {} inputs and {} filters",
                               layer.groups, layer.in.channels, filters));
    }
    layer.out = {side_after(section, layer.in.width, layer, 2 * layer.pad),
                 side_after(section, layer.in.height, layer, 2 * layer.pad), filters};
    const std::int64_t weights = std::int64_t{layer.size} * layer.size * filters;
    if (weights * (layer.in.channels / layer.groups) > kMostNumbers) {
      section.fail(fmt::format("more than {} weights", kMostNumbers));
    }
  }

  void maxpool(Section& section, Layer& layer) const {
    layer.stride = section.integer("stride", 1, 1, kLargestWindow);
    layer.size = section.integer("size", layer.stride, 1, kLargestWindow);
    layer.pad = section.integer("padding", layer.size - 1, 0, layer.size - 1);
    layer.out = {side_after(section, layer.in.width, layer, layer.pad),
                 side_after(section, layer.in.height, layer, layer.pad), layer.in.channels};
  }

  void upsample(Section& section, Layer& layer) const {
    layer.stride = section.integer("stride", 2, 1, 32);
    if (section.real("scale", 1, -1e6F, 1e6F) != 1) section.fail("scale", "expected 1");
    layer.out = {layer.in.width * layer.stride, layer.in.height * layer.stride, layer.in.channels};
    if (layer.out.width > kLargestSide || layer.out.height > kLargestSide) {
      section.fail(fmt::format("{} is larger than {}", to_text(layer.out), kLargestSide));
    }
  }

  /// A layer named by number, or by how far back it is.
  int reference(Section& section, const char* key, int named) const {
    const int here = static_cast<int>(model_.layers.size());
    const int layer = named < 0 ? here + named : named;
    if (layer < 0 || layer >= here) {
      section.fail(key, fmt::format("this is layer {}: expected layers from 0 to {}, or from -{} "
                                    "to -1",
                                    here, here - 1, here));
    }
    return layer;
  }

  void route(Section& section, Layer& layer) const {
    layer.inputs.clear();
    for (const int named : section.integers("layers", -100000, 100000)) {
      layer.inputs.push_back(reference(section, "layers", named));
    }
    if (layer.inputs.empty()) section.fail("no option 'layers'");
    layer.groups = section.integer("groups", 1, 1, kMostChannels);
    layer.group_id = section.integer("group_id", 0, 0, layer.groups - 1);
    layer.in = extent_of(layer.inputs[0]);
    layer.out = {layer.in.width, layer.in.height, 0};
    for (const int input : layer.inputs) {
      const Extent& e = extent_of(input);
      if (e.width != layer.in.width || e.height != layer.in.height) {
        section.fail("layers", fmt::format("layer {} is {} and layer {} is {}: they cannot be "
                                           "joined",
                                           layer.inputs[0], to_text(layer.in), input, to_text(e)));
      }
      if (e.channels % layer.groups != 0) {
        section.fail("groups",
                     fmt::format("does not divide the {} channels of layer {}", e.channels, input));
      }
      layer.out.channels += e.channels / layer.groups;
      if (layer.out.channels > kMostChannels) {
        section.fail("layers", fmt::format("more than {} channels", kMostChannels));
      }
    }
  }

  void shortcut(Section& section, Layer& layer) const {
    const std::vector<int> from = section.integers("from", -100000, 100000);
    if (from.size() != 1) section.fail("from", "expected one layer");
    if (model_.layers.empty()) section.fail("no layer before it");
    layer.inputs.push_back(reference(section, "from", from[0]));
    layer.activation = activation_of(section, "linear");
    const Extent& other = extent_of(layer.inputs[1]);
    if (!(other == layer.in)) {
      section.fail("from", fmt::format("layer {} is {}, expected {} as the layer before", from[0],
                                       to_text(other), to_text(layer.in)));
    }
    layer.out = layer.in;
  }

  void yolo(Section& section, Layer& layer) const {
    Yolo& y = layer.yolo;
    y.classes = section.integer("classes", 20, 1, kMostChannels);
    const int count = section.integer("num", 1, 1, kMostAnchors);
    const std::vector<float> sides = section.reals("anchors", 0.01F, 1e6F);
    if (sides.size() != 2 * static_cast<std::size_t>(count)) {
      section.fail("anchors",
                   fmt::format("{} numbers, expected 2 for each of num={}", sides.size(), count));
    }
    for (std::size_t i = 0; i < sides.size(); i += 2) y.anchors.push_back({sides[i], sides[i + 1]});
    y.mask = section.integers("mask", 0, count - 1);
    for (int i = 0; y.mask.empty() && i < count; ++i) y.mask.push_back(i);
    y.scale_x_y = section.real("scale_x_y", 1, 0.1F, 10);
    if (section.integer("new_coords", 0, 0, 1) != 0) {
      section.fail("new_coords", "boxes in this form are not supported, expected 0");
    }
    section.ignore({"ignore_thresh",
                    "truth_thresh",
                    "jitter",
                    "random",
                    "iou_loss",
                    "iou_thresh",
                    "cls_normalizer",
                    "iou_normalizer",
                    "obj_normalizer",
                    "delta_normalizer",
                    "max_delta",
                    "nms_kind",
                    "beta_nms",
                    "resize",
                    "label_smooth_eps",
                    "focal_loss",
                    "counters_per_class",
                    "objectness_smooth",
                    "max",
                    "map",
                    "scale_x_y"});
    const auto wanted = static_cast<std::int64_t>(y.mask.size()) * (5 + y.classes);
    if (wanted != layer.in.channels) {
      section.fail(
          fmt::format("{} channels come in, expected {}: (4 + 1 + {} classes) for each of "
                      "{} anchors",
                      layer.in.channels, wanted, y.classes, y.mask.size()));
    }
    layer.out = layer.in;
  }

  Model& model_;
};

void read_net(Section& net, Model& model, std::optional<int> side) {
  model.input.width = net.required_integer("width", 1, kLargestSide);
  model.input.height = net.required_integer("height", 1, kLargestSide);
  model.input.channels = net.integer("channels", 3, 1, 16);
  if (side) model.input.width = model.input.height = *side;
  net.ignore({"batch",
              "subdivisions",
              "momentum",
              "decay",
              "angle",
              "saturation",
              "exposure",
              "hue",
              "learning_rate",
              "burn_in",
              "max_batches",
              "policy",
              "steps",
              "scales",
              "mosaic",
              "mixup",
              "cutmix",
              "flip",
              "letter_box",
              "power",
              "ema_alpha",
              "max_crop",
              "min_crop",
              "optimized_memory",
              "workspace_size_limit_MB",
              "blur",
              "adam",
              "weights_reject_freq",
              "equidistant_point",
              "num_sigmas_reject_badlabels",
              "badlabels_rejection_percentage",
              "resize_step"});
  net.expect_all_read();
}

}  // namespace

std::string_view to_string(LayerKind kind) {
  return kKinds[static_cast<std::size_t>(kind)].first;
}

std::string_view to_string(Activation activation) {
  return kActivations[static_cast<std::size_t>(activation)].first;
}

Model parse_cfg(std::string_view text, const std::string& path, std::optional<int> side) {
  std::vector<Section> sections = parse_sections(text, path);
  if (sections.empty()) throw Error(fmt::format("{}: no section, expected [net]", path));
  if (sections[0].name() != "net" && sections[0].name() != "network") {
    sections[0].fail("expected [net] first");
  }
  if (sections.size() == 1) throw Error(fmt::format("{}: no layer after [net]", path));
  Model model;
  model.path = path;
  read_net(sections[0], model, side);
  Reader reader(model);
  for (std::size_t i = 1; i < sections.size(); ++i) reader.read(sections[i]);
  return model;
}

Model read_cfg(const std::string& path, std::optional<int> side) {
  return parse_cfg(read_file(path), path, side);
}

}  // namespace partita::io::darknet
