#include "host/tasks/detection/darknet_network.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/kernel.h"
#include "host/tasks/detection/kernels.h"
#include "host/tasks/detection/packing.h"
#include "host/tasks/detection/spec_helpers.h"

namespace partita::detection {
namespace {

using io::darknet::Layer;
using io::darknet::Model;
using io::darknet::Weights;
using runtime::Kernel;
using runtime::Session;

constexpr int kTimedLaunches = 4;  // between two waits, so that these weigh little

/// Arguments of a kernel that stay the same from picture to picture, in order.
class Arguments {
 public:
  explicit Arguments(Kernel& kernel) : kernel_(&kernel) {}
  void buffer(const cl::Buffer& b) {
    const cl_mem memory = b();
    kernel_->set_raw(index_++, sizeof memory, &memory);
  }
  void integer(std::int64_t value) {
    const auto narrow = static_cast<cl_int>(value);
    kernel_->set_raw(index_++, sizeof narrow, &narrow);
  }
  void view(const TensorView& v) {
    for (const std::int32_t value : {v.offset, v.row, v.pixel}) integer(value);
  }
  void entries(const runtime::Shape& shape, std::initializer_list<const char*> names) {
    for (const char* name : names) integer(shape[name]);
  }
  void activation(const runtime::Shape& shape) {
    const ActivationCode code = activation_of(shape);
    kernel_->set_raw(index_++, sizeof code.slope, &code.slope);
    integer(code.code);
  }

 private:
  Kernel* kernel_;
  cl_uint index_ = 0;
};

}  // namespace

struct DarknetNetwork::Impl {
  Impl(const Session& s, Model m, const Weights& weights);

  void prepare(const PlannedStep& step, const Weights& weights);
  void prepare_convolution(const PlannedStep& step, const Weights& weights, Arguments arguments);
  cl::Buffer upload(const std::vector<float>& numbers);
  const cl::Buffer& memory_of(const PlannedMap& map) const {
    return slots[plan.buffers[map.buffer].slot];
  }
  /// The view that a convolution reads: its first window.
  TensorView windows(const PlannedStep& step) const {
    TensorView view = plan.view(step.in);
    view.offset -= step.pad * (view.row + view.pixel);
    return view;
  }
  void write_picture(std::span<const float> picture);
  void read_outputs();

  const Session* session;
  Model model;
  Plan plan;
  std::vector<cl::Buffer> slots;
  std::vector<cl::Buffer> weight_buffers;
  std::vector<std::pair<Kernel, runtime::Shape>> launches;
  std::vector<float> picture;  ///< as the device has it, border included
  std::vector<float> scratch;
  std::vector<RawOutput> outputs;
  std::size_t weight_bytes = 0;
};

DarknetNetwork::Impl::Impl(const Session& s, Model m, const Weights& weights)
    : session(&s), model(std::move(m)), plan(make_plan(model)) {
  if (weights.size() != model.layers.size()) {
    throw Error(fmt::format("{}: weights of {} layers, expected {}", model.path, weights.size(),
                            model.layers.size()));
  }
  for (const std::size_t numbers : plan.slots) {
    slots.push_back(session->make_buffer(numbers * sizeof(float)));
  }
  for (const PlannedStep& step : plan.steps) prepare(step, weights);
  picture.resize(plan.buffers[0].layout.count());
  for (const auto& [layer, map] : plan.outputs) {
    const auto& e = map.extent;
    outputs.push_back({layer, e.width, e.height, e.channels, std::vector<float>(e.count())});
  }
}

cl::Buffer DarknetNetwork::Impl::upload(const std::vector<float>& numbers) {
  const cl::Buffer buffer = session->make_buffer(numbers.size() * sizeof(float), CL_MEM_READ_ONLY);
  session->write(buffer, std::as_bytes(std::span(numbers)));
  session->finish();  // `numbers` may die
  weight_bytes += numbers.size() * sizeof(float);
  weight_buffers.push_back(buffer);
  return buffer;
}

void DarknetNetwork::Impl::prepare_convolution(const PlannedStep& step, const Weights& weights,
                                               Arguments arguments) {
  const Layer& layer = model.layers[step.layer];
  const bool depthwise = step.kernel == StepKernel::depthwise;
  const PackedWeights packed = depthwise ? pack_depthwise(layer, weights[step.layer])
                                         : pack_convolution(layer, weights[step.layer], step.group,
                                                            static_cast<int>(step.shape["lanes"]));
  arguments.buffer(memory_of(step.in));
  arguments.buffer(upload(packed.weights));
  arguments.buffer(upload(packed.bias));
  arguments.buffer(memory_of(step.other.value_or(step.in)));
  arguments.buffer(memory_of(step.out));
  arguments.view(windows(step));
  arguments.view(step.other ? plan.view(*step.other) : TensorView{});
  arguments.view(plan.view(step.out));
  if (depthwise) {
    arguments.entries(step.shape, {"width", "height", "channels", "size", "stride", "border"});
  } else {
    arguments.entries(
        step.shape, {"width", "height", "inputs", "outputs", "size", "stride", "lanes", "border"});
  }
  arguments.activation(step.shape);
}

void DarknetNetwork::Impl::prepare(const PlannedStep& step, const Weights& weights) {
  launches.emplace_back(Kernel(*session, spec_of(step.kernel)), step.shape);
  Arguments arguments(launches.back().first);
  switch (step.kernel) {
    case StepKernel::convolution:
    case StepKernel::depthwise:
      prepare_convolution(step, weights, arguments);
      return;
    case StepKernel::maxpool:
    case StepKernel::upsample:
      arguments.buffer(memory_of(step.in));
      arguments.buffer(memory_of(step.out));
      arguments.view(plan.view(step.in));
      arguments.view(plan.view(step.out));
      if (step.kernel == StepKernel::upsample) {
        arguments.entries(step.shape, {"width", "height", "channels", "stride", "border"});
      } else {
        arguments.entries(step.shape, {"in_width", "in_height", "width", "height", "channels",
                                       "size", "stride", "before", "border"});
      }
      return;
    case StepKernel::add:
      arguments.buffer(memory_of(step.in));
      arguments.buffer(memory_of(*step.other));
      arguments.buffer(memory_of(step.out));
      arguments.view(plan.view(step.in));
      arguments.view(plan.view(*step.other));
      arguments.view(plan.view(step.out));
      arguments.entries(step.shape, {"width", "height", "channels", "border"});
      arguments.activation(step.shape);
      return;
  }
}

void DarknetNetwork::Impl::write_picture(std::span<const float> pixels) {
  const TensorLayout& layout = plan.buffers[0].layout;
  const auto line = static_cast<std::size_t>(layout.width * layout.channels);
  for (int y = 0; y < layout.height; ++y) {
    std::copy_n(pixels.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * line),
                line, picture.begin() + static_cast<std::ptrdiff_t>(layout.view(0).at(0, y, 0)));
  }
  session->write(slots[0], std::as_bytes(std::span(picture)));
}

void DarknetNetwork::Impl::read_outputs() {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    RawOutput& out = outputs[i];
    const PlannedMap& map = plan.outputs[i].second;
    const TensorLayout& layout = plan.buffers[map.buffer].layout;
    if (layout.border == 0 && layout.channels == out.channels) {
      session->read(memory_of(map), std::as_writable_bytes(std::span(out.values)));
      continue;
    }
    scratch.resize(layout.count());
    session->read(memory_of(map), std::as_writable_bytes(std::span(scratch)));
    const TensorView view = plan.view(map);
    auto target = out.values.begin();
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        target = std::copy_n(&scratch[view.at(x, y, 0)], out.channels, target);
      }
    }
  }
}

DarknetNetwork::DarknetNetwork(const Session& session, Model model, const Weights& weights)
    : impl_(std::make_unique<Impl>(session, std::move(model), weights)) {}
DarknetNetwork::~DarknetNetwork() = default;
DarknetNetwork::DarknetNetwork(DarknetNetwork&&) noexcept = default;
DarknetNetwork& DarknetNetwork::operator=(DarknetNetwork&&) noexcept = default;

const Model& DarknetNetwork::model() const {
  return impl_->model;
}
const Plan& DarknetNetwork::plan() const {
  return impl_->plan;
}

const std::vector<RawOutput>& DarknetNetwork::run(std::span<const float> picture,
                                                  std::int64_t frame) {
  Impl& net = *impl_;
  if (picture.size() != net.model.input.count()) {
    const auto& e = net.model.input;
    throw Error(fmt::format("{}: a picture of {} numbers, expected {} x {} x {}", net.model.path,
                            picture.size(), e.width, e.height, e.channels));
  }
  net.session->extension().set_label("detection", frame);
  net.write_picture(picture);
  for (auto& [kernel, shape] : net.launches) kernel.enqueue(shape);
  net.read_outputs();
  return net.outputs;
}

void DarknetNetwork::warm_up() {
  run(std::vector<float>(impl_->model.input.count(), 0.5F));
}

std::vector<double> DarknetNetwork::time_steps(std::span<const float> picture, int rounds) {
  Impl& net = *impl_;
  run(picture);
  std::vector<double> seconds;
  for (auto& [kernel, shape] : net.launches) {  // in order, so that each finds its inputs
    kernel.enqueue(shape);
    net.session->finish();
    double best = 0;
    for (int round = 0; round < rounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      for (int i = 0; i < kTimedLaunches; ++i) kernel.enqueue(shape);
      net.session->finish();
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
      if (round == 0 || taken.count() < best) best = taken.count();
    }
    seconds.push_back(best / kTimedLaunches);
  }
  return seconds;
}

std::size_t DarknetNetwork::activation_bytes() const {
  return impl_->plan.slot_numbers() * sizeof(float);
}
std::size_t DarknetNetwork::weight_bytes() const {
  return impl_->weight_bytes;
}

}  // namespace partita::detection
