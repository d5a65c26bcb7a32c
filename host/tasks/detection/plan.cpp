#include "host/tasks/detection/plan.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/tasks/detection/kernels.h"

namespace partita::detection {
namespace {

using io::darknet::Activation;
using io::darknet::Extent;
using io::darknet::kPicture;
using io::darknet::Layer;
using io::darknet::LayerKind;
using io::darknet::Model;
using runtime::Shape;

constexpr int kLargestDepthwise = 11;  // window, as kernels/detection/depthwise.fpga.cl holds it

bool is_depthwise(const Layer& layer) {
  return layer.groups > 1 && layer.groups == layer.in.channels &&
         layer.groups == layer.out.channels && layer.size <= kLargestDepthwise;
}

class Planner {
 public:
  explicit Planner(const Model& model)
      : model_(model),
        fused_(model.layers.size(), false),
        places_(model.layers.size()),
        maps_(model.layers.size()) {}

  Plan make() {
    count_readers();
    fuse_shortcuts();
    place_joined();
    plan_.buffers.push_back({.layout = layout_of(model_.input)});
    for (std::size_t i = 0; i < model_.layers.size(); ++i) add(i);
    if (plan_.outputs.empty()) throw Error(fmt::format("{}: no [yolo] layer", model_.path));
    for (const PlannedStep& step : plan_.steps) {
      int& border = plan_.buffers[step.in.buffer].layout.border;
      border = std::max(border, step.pad);
    }
    for (std::size_t i = 0; i < plan_.steps.size(); ++i) find_shape(i);
    share_memory();
    return std::move(plan_);
  }

 private:
  struct Place {
    std::size_t route = 0;
    int first_channel = 0;
  };

  const Layer& layer(int i) const { return model_.layers[static_cast<std::size_t>(i)]; }

  static TensorLayout layout_of(const Extent& e) { return {e.width, e.height, e.channels, 0}; }

  /// The layer whose numbers a layer's result is, whole and as they are.
  int source(int i) const {
    while (i != kPicture) {
      const Layer& l = layer(i);
      const bool same = l.kind == LayerKind::dropout || l.kind == LayerKind::yolo ||
                        (l.kind == LayerKind::route && l.inputs.size() == 1 && l.groups == 1);
      if (!same) break;
      i = l.inputs[0];
    }
    return i;
  }

  void count_readers() {
    readers_.assign(model_.layers.size(), 0);
    for (const Layer& l : model_.layers) {
      const bool reads = l.kind != LayerKind::dropout;
      for (const int input : l.inputs) {
        const int from = source(input);
        if (reads && from != kPicture) ++readers_[static_cast<std::size_t>(from)];
      }
    }
  }

  /// A shortcut right after a convolution that nobody else reads.
  void fuse_shortcuts() {
    for (std::size_t i = 0; i < model_.layers.size(); ++i) {
      const Layer& l = model_.layers[i];
      if (l.kind != LayerKind::shortcut || l.activation != Activation::linear) continue;
      const int before = source(l.inputs[0]), other = source(l.inputs[1]);
      if (before == kPicture || layer(before).kind != LayerKind::convolutional) continue;
      const auto b = static_cast<std::size_t>(before);
      if (readers_[b] == 1 && other < before && !fused_[b]) {
        fused_[b] = true;
        fused_into_[b] = i;
      }
    }
  }

  /// Which maps are written right into a route's.
  void place_joined() {
    for (std::size_t i = 0; i < model_.layers.size(); ++i) {
      const Layer& l = model_.layers[i];
      if (l.kind != LayerKind::route || l.inputs.size() < 2) continue;
      int first = 0;
      for (const int input : l.inputs) {
        const int from = source(input);
        if (l.groups == 1 && from != kPicture && layer(from).kind != LayerKind::route) {
          std::optional<Place>& place = places_[static_cast<std::size_t>(from)];
          if (!place) place = Place{i, first};
        }
        first += extent_of(input).channels / l.groups;
      }
      joined_.emplace(i, SIZE_MAX);
    }
  }

  const Extent& extent_of(int i) const { return i == kPicture ? model_.input : layer(i).out; }

  PlannedMap map_of(int i) const {
    return i == kPicture ? PlannedMap{0, 0, model_.input} : maps_[static_cast<std::size_t>(i)];
  }

  std::size_t new_buffer(const Extent& extent) {
    plan_.buffers.push_back({.layout = layout_of(extent), .first_step = plan_.steps.size()});
    return plan_.buffers.size() - 1;
  }

  /// A route's memory, made when the first of its inputs is written.
  std::size_t joined_buffer(std::size_t route) {
    std::size_t& buffer = joined_.at(route);
    if (buffer == SIZE_MAX) buffer = new_buffer(model_.layers[route].out);
    return buffer;
  }

  /// Where the layer's own numbers go.
  PlannedMap new_map(std::size_t i) {
    const Extent& extent = model_.layers[i].out;
    if (const auto& place = places_[i]) {
      return {joined_buffer(place->route), place->first_channel, extent};
    }
    return {new_buffer(extent), 0, extent};
  }

  void add(std::size_t i) {
    const Layer& l = model_.layers[i];
    PlannedMap& map = maps_[i];
    switch (l.kind) {
      case LayerKind::convolutional:
        add_convolution(i);
        break;
      case LayerKind::maxpool:
        map = new_map(i);
        push({.kernel = StepKernel::maxpool, .layer = i, .in = map_of(l.inputs[0]), .out = map});
        break;
      case LayerKind::upsample:
        map = new_map(i);
        push({.kernel = StepKernel::upsample, .layer = i, .in = map_of(l.inputs[0]), .out = map});
        break;
      case LayerKind::shortcut:
        if (map.extent.channels != 0) break;  // the convolution has written it
        map = new_map(i);
        push({.kernel = StepKernel::add,
              .layer = i,
              .in = map_of(l.inputs[0]),
              .out = map,
              .other = map_of(l.inputs[1])});
        break;
      case LayerKind::route:
        add_route(i);
        break;
      case LayerKind::dropout:
        map = map_of(l.inputs[0]);
        break;
      case LayerKind::yolo:
        map = map_of(l.inputs[0]);
        plan_.outputs.emplace_back(i, map);
        break;
    }
  }

  void push(PlannedStep step) { plan_.steps.push_back(std::move(step)); }

  void add_convolution(std::size_t i) {
    const Layer& l = model_.layers[i];
    const std::size_t result = fused_[i] ? fused_into_.at(i) : i;
    const PlannedMap out = maps_[result] = new_map(result);
    maps_[i] = out;
    PlannedStep step{.layer = i, .in = map_of(l.inputs[0]), .out = out, .pad = l.pad};
    if (fused_[i]) step.other = map_of(model_.layers[result].inputs[1]);
    if (is_depthwise(l)) {
      step.kernel = StepKernel::depthwise;
      push(step);
      return;
    }
    step.in.extent.channels /= l.groups;
    step.out.extent.channels /= l.groups;
    for (int g = 0; g < l.groups; ++g) {
      step.group = g;
      push(step);
      step.in.first_channel += step.in.extent.channels;
      step.out.first_channel += step.out.extent.channels;
      if (step.other) step.other->first_channel += step.out.extent.channels;
    }
  }

  void add_route(std::size_t i) {
    const Layer& l = model_.layers[i];
    if (l.inputs.size() == 1) {
      PlannedMap map = map_of(l.inputs[0]);
      map.first_channel += l.group_id * l.out.channels;
      map.extent = l.out;
      maps_[i] = map;
      return;
    }
    maps_[i] = {joined_buffer(i), 0, l.out};
    int first = 0;
    for (const int input : l.inputs) {
      PlannedMap from = map_of(input);
      from.extent.channels /= l.groups;
      from.first_channel += l.group_id * from.extent.channels;
      PlannedMap to{maps_[i].buffer, first, from.extent};
      first += from.extent.channels;
      if (from.buffer == to.buffer && from.first_channel == to.first_channel) continue;
      push({.kernel = StepKernel::upsample, .layer = i, .in = from, .out = to});
    }
  }

  void find_shape(std::size_t index) {
    PlannedStep& step = plan_.steps[index];
    const Layer& l = model_.layers[step.layer];
    const int border = plan_.buffers[step.out.buffer].layout.border;
    const Extent& out = step.out.extent;
    Shape shape{{"width", out.width}, {"height", out.height}, {"border", border}};
    const bool convolves =
        step.kernel == StepKernel::convolution || step.kernel == StepKernel::depthwise;
    if (step.kernel == StepKernel::convolution) {
      shape = shape.with("inputs", step.in.extent.channels)
                  .with("outputs", out.channels)
                  .with("lanes", lanes_for(out.channels));
    } else {
      shape = shape.with("channels", out.channels);
    }
    if (convolves) {
      shape = shape.with("size", l.size)
                  .with("stride", l.stride)
                  .with("residual", step.other.has_value());
    }
    if (convolves || step.kernel == StepKernel::add) {
      shape = shape.with("activation", static_cast<std::int64_t>(l.activation));
    }
    if (step.kernel == StepKernel::maxpool) {
      shape = shape.with("size", l.size)
                  .with("stride", l.stride)
                  .with("before", l.pad / 2)
                  .with("in_width", step.in.extent.width)
                  .with("in_height", step.in.extent.height);
    }
    if (step.kernel == StepKernel::upsample) {
      shape = shape.with("stride", l.kind == LayerKind::upsample ? l.stride : 1);
    }
    step.shape = shape;
  }

  /// Largest first: a buffer goes into the smallest slot whose others are not in use at the same
  /// time, else into a new one. The picture's border stays zero, so its slot is its own.
  void share_memory() {
    find_last_steps();
    std::vector<PlannedBuffer>& buffers = plan_.buffers;
    plan_.slots = {buffers[0].layout.count()};
    std::vector<std::vector<std::size_t>> members{{0}};
    std::vector<std::size_t> order(buffers.size() - 1);
    std::iota(order.begin(), order.end(), 1);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return buffers[a].layout.count() > buffers[b].layout.count();
    });
    for (const std::size_t b : order) {
      const auto free = [&](std::size_t slot) {
        return std::all_of(members[slot].begin(), members[slot].end(), [&](std::size_t other) {
          return buffers[other].last_step < buffers[b].first_step ||
                 buffers[b].last_step < buffers[other].first_step;
        });
      };
      std::size_t slot = plan_.slots.size();  // they are made in descending order
      for (std::size_t s = 1; s < plan_.slots.size(); ++s) {
        if (free(s)) slot = s;
      }
      if (slot == plan_.slots.size()) {
        plan_.slots.push_back(buffers[b].layout.count());
        members.emplace_back();
      }
      members[slot].push_back(b);
      buffers[b].slot = slot;
    }
  }

  void find_last_steps() {
    constexpr std::size_t kAlways = std::numeric_limits<std::size_t>::max();
    std::vector<PlannedBuffer>& buffers = plan_.buffers;
    for (std::size_t i = 0; i < plan_.steps.size(); ++i) {
      const PlannedStep& step = plan_.steps[i];
      for (const std::size_t b :
           {step.in.buffer, step.out.buffer, step.other ? step.other->buffer : step.out.buffer}) {
        buffers[b].last_step = std::max(buffers[b].last_step, i);
      }
    }
    for (const auto& [layer, map] : plan_.outputs) buffers[map.buffer].last_step = kAlways;
    buffers[0].last_step = kAlways;
  }

  const Model& model_;
  Plan plan_;
  std::vector<int> readers_;
  std::vector<bool> fused_;                        ///< convolutions that add a shortcut
  std::map<std::size_t, std::size_t> fused_into_;  ///< and its layer
  std::vector<std::optional<Place>> places_;       ///< of layers written into a route's map
  std::map<std::size_t, std::size_t> joined_;      ///< buffer of a route of several layers
  std::vector<PlannedMap> maps_;                   ///< of each layer so far
};

}  // namespace

const runtime::KernelSpec& spec_of(StepKernel kernel) {
  switch (kernel) {
    case StepKernel::convolution:
      return convolution_spec();
    case StepKernel::depthwise:
      return depthwise_spec();
    case StepKernel::maxpool:
      return maxpool_spec();
    case StepKernel::upsample:
      return upsample_spec();
    case StepKernel::add:
      break;
  }
  return add_spec();
}

std::size_t Plan::slot_numbers() const {
  return std::accumulate(slots.begin(), slots.end(), std::size_t{0});
}

std::size_t Plan::live_numbers() const {
  std::size_t most = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    std::size_t live = 0;
    for (const PlannedBuffer& b : buffers) {
      if (b.first_step <= i && i <= b.last_step) live += b.layout.count();
    }
    most = std::max(most, live);
  }
  return most;
}

Plan make_plan(const Model& model) {
  return Planner(model).make();
}

}  // namespace partita::detection
