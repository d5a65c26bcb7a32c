#include "host/tasks/tracking/filters.h"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "host/runtime/error.h"
#include "host/runtime/host_step.h"
#include "host/runtime/kernel.h"
#include "host/tasks/tracking/kernels.h"
#include "host/tasks/tracking/shapes.h"
#include "host/tasks/tracking/tables.h"
#include "host/tasks/tracking/windows.h"

namespace partita::tracking {
namespace {

using runtime::Kernel;
using runtime::Session;

constexpr int kSmallestSide = 16;   ///< of a picture, px
constexpr int kLargestSide = 8192;  ///< so that windows around its boxes fit 16.16

template <typename T>
void check(const char* name, T value, T least, T most) {
  if (value >= least && value <= most) return;  // false for NaN as well
  throw Error(fmt::format("tracking: {} is {}, expected {} to {}", name, value, least, most));
}

void check_parameters(const FilterParameters& p) {
  if (p.template_side != 64 && p.template_side != 128) {
    throw Error(fmt::format("tracking: template_side is {}, expected 64 or 128", p.template_side));
  }
  check("padding", p.padding, 1.1, 5.0);
  check("sigma", p.sigma, 0.05, 5.0);
  check("label_deviation", p.label_deviation, 0.01, 1.0);
  check("regularisation", p.regularisation, 1e-6, 1.0);
  check("rate", p.rate, 0.0, 1.0);
  check("scales", p.scales, 1, 7);
  if (p.scales % 2 == 0) {
    throw Error(fmt::format("tracking: scales is {}, expected an odd number", p.scales));
  }
  check("scale_step", p.scale_step, 1.005, 1.5);
  check("scale_penalty", p.scale_penalty, 0.5, 1.0);
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}

}  // namespace

struct Filters::Impl {
  Impl(const Session& s, Picture picture, const FilterParameters& p, int capacity);

  void look_at(const sensing::GrayImage& image);
  std::vector<Located> locate(std::span<const Target> targets);
  void train(std::span<const Target> targets);
  void send(std::span<const Target> targets, int scales);
  void extract(std::int64_t patches);

  const Session* session;
  Picture size;
  FilterParameters parameters;
  int cells;
  float falloff;
  Kernel resample, cell_histograms, cell_features, spectra, correlate, respond, train_kernel;
  cl::Buffer image, windows, slots, rates, patches, histograms, features, spectrum, kernels, peaks;
  cl::Buffer identity;  ///< slots of patches that are correlated with themselves
  cl::Buffer twiddles, taper, label, filters, models;
  // Written without waiting, so they live as long as the queue may read them.
  std::vector<Window> host_windows;
  std::vector<std::int32_t> host_slots;
  std::vector<float> host_rates;
  std::int64_t samples = 0;  ///< of the windows sent last
};

Filters::Impl::Impl(const Session& s, Picture picture, const FilterParameters& p, int capacity)
    : session(&s),
      size(picture),
      parameters(p),
      cells(p.template_side / kCell),
      resample(s, resample_spec()),
      cell_histograms(s, cell_histograms_spec()),
      cell_features(s, cell_features_spec()),
      spectra(s, spectra_spec()),
      correlate(s, correlate_spec()),
      respond(s, respond_spec()),
      train_kernel(s, train_spec()) {
  const auto plane = static_cast<std::size_t>(cells * cells);
  const auto targets = static_cast<std::size_t>(capacity);
  const std::size_t count = targets * static_cast<std::size_t>(p.scales);
  const std::size_t complex_plane = 2 * plane * sizeof(float);
  falloff = static_cast<float>(1.0 / (p.sigma * p.sigma * kChannels * static_cast<double>(plane)));
  image =
      s.make_buffer(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height),
                    CL_MEM_READ_ONLY);
  windows = s.make_buffer(count * sizeof(Window), CL_MEM_READ_ONLY);
  slots = s.make_buffer(targets * sizeof(std::int32_t), CL_MEM_READ_ONLY);
  rates = s.make_buffer(targets * sizeof(float), CL_MEM_READ_ONLY);
  identity = s.make_buffer(targets * sizeof(std::int32_t), CL_MEM_READ_ONLY);
  patches = s.make_buffer(count * kCell * kCell * plane * sizeof(std::uint16_t));
  histograms = s.make_buffer(count * kBins * plane * sizeof(std::int32_t));
  features = s.make_buffer(count * kChannels * plane * sizeof(float));
  spectrum = s.make_buffer(count * kChannels * complex_plane);
  kernels = s.make_buffer(count * complex_plane);
  peaks = s.make_buffer(count * kPeakEntries * sizeof(float));
  filters = s.make_buffer(targets * complex_plane);
  models = s.make_buffer(targets * kChannels * complex_plane);
  twiddles = s.make_buffer(static_cast<std::size_t>(cells) * sizeof(float), CL_MEM_READ_ONLY);
  taper = s.make_buffer(static_cast<std::size_t>(cells) * sizeof(float), CL_MEM_READ_ONLY);
  label = s.make_buffer(complex_plane);
  std::vector<std::int32_t> numbers(targets);
  for (std::size_t i = 0; i < targets; ++i) numbers[i] = static_cast<std::int32_t>(i);
  const std::vector<float> twiddle_values = twiddle_table(cells);
  const std::vector<float> taper_values = taper_table(cells);
  // The box's side is cells / padding.
  const std::vector<float> label_values = label_plane(cells, p.label_deviation * cells / p.padding);
  s.write(identity, bytes_of(numbers));
  s.write(twiddles, bytes_of(twiddle_values));
  s.write(taper, bytes_of(taper_values));
  s.write(features, bytes_of(label_values));
  spectra.launch(planes_shape(cells, 1), features, twiddles, label, cells, 1);
  s.finish();
}

void Filters::Impl::look_at(const sensing::GrayImage& picture) {
  if (picture.width != size.width || picture.height != size.height) {
    throw Error(fmt::format("tracking: a picture of {} x {}, expected {} x {}", picture.width,
                            picture.height, size.width, size.height));
  }
  session->write(image, bytes_of(picture.pixels));
}

/// Windows and slots of the targets, at all scales or the middle one.
void Filters::Impl::send(std::span<const Target> targets, int scales) {
  host_windows.clear();
  host_slots.clear();
  samples = 0;
  const int middle = parameters.scales / 2;
  for (const Target& target : targets) {
    host_slots.push_back(target.slot);
    for (int s = 0; s < scales; ++s) {
      const double factor = scale_factor(parameters, scales == 1 ? middle : s);
      host_windows.push_back(make_window(parameters, target.box, factor));
      const int side = parameters.template_side;
      samples += static_cast<std::int64_t>(side * side) << (2 * host_windows.back()[4]);
    }
  }
  session->write(windows, bytes_of(host_windows));
  session->write(slots, bytes_of(host_slots));
}

/// Spectra of the features of the patches in the windows.
void Filters::Impl::extract(std::int64_t count) {
  const int n = static_cast<int>(count);
  resample.launch(resample_shape(size, cells, count, samples), image, windows, patches, size.width,
                  size.height, parameters.template_side, n);
  cell_histograms.launch(patches_shape(cells, count), patches, histograms, cells, n);
  cell_features.launch(patches_shape(cells, count), histograms, taper, features, cells, n);
  spectra.launch(planes_shape(cells, count * kChannels), features, twiddles, spectrum, cells,
                 n * kChannels);
}

std::vector<Located> Filters::Impl::locate(std::span<const Target> targets) {
  std::vector<Located> found;
  if (targets.empty()) return found;
  const int scales = parameters.scales;
  const auto count = static_cast<std::int64_t>(targets.size()) * scales;
  const int n = static_cast<int>(count);
  send(targets, scales);
  extract(count);
  correlate.launch(scales_shape(cells, count, scales), models, spectrum, slots, twiddles, kernels,
                   cells, scales, n, falloff);
  respond.launch(scales_shape(cells, count, scales), kernels, filters, slots, twiddles, peaks,
                 cells, scales, n);
  const auto entries = static_cast<std::size_t>(scales) * kPeakEntries;
  std::vector<float> values(targets.size() * entries);
  session->read(peaks, std::as_writable_bytes(std::span(values)));
  for (std::size_t t = 0; t < targets.size(); ++t) {
    found.push_back(interpret_peaks(parameters, targets[t].box,
                                    std::span(values).subspan(t * entries, entries), size));
  }
  declare_host_step(*session, locate_spec(),
                    locate_shape(static_cast<std::int64_t>(targets.size()), count));
  return found;
}

void Filters::Impl::train(std::span<const Target> targets) {
  if (targets.empty()) return;
  const auto count = static_cast<std::int64_t>(targets.size());
  const int n = static_cast<int>(count);
  host_rates.clear();
  for (const Target& target : targets) {
    host_rates.push_back(target.fresh ? 1.0f : static_cast<float>(parameters.rate));
  }
  send(targets, 1);
  session->write(rates, bytes_of(host_rates));
  extract(count);
  correlate.launch(scales_shape(cells, count, 1), spectrum, spectrum, identity, twiddles, kernels,
                   cells, 1, n, falloff);
  train_kernel.launch(train_shape(cells, count), kernels, spectrum, label, slots, rates, filters,
                      models, cells, n, static_cast<float>(parameters.regularisation));
}

Filters::Filters(const Session& session, int width, int height, const FilterParameters& parameters,
                 int capacity) {
  check_parameters(parameters);
  check("the picture's width", width, kSmallestSide, kLargestSide);
  check("the picture's height", height, kSmallestSide, kLargestSide);
  check("the capacity", capacity, 1, 1024);
  impl_ = std::make_unique<Impl>(session, Picture{width, height}, parameters, capacity);
}
Filters::~Filters() = default;
Filters::Filters(Filters&&) noexcept = default;
Filters& Filters::operator=(Filters&&) noexcept = default;

void Filters::look_at(const sensing::GrayImage& image) {
  impl_->look_at(image);
}
std::vector<Located> Filters::locate(std::span<const Target> targets) {
  return impl_->locate(targets);
}
void Filters::train(std::span<const Target> targets) {
  impl_->train(targets);
}
void Filters::finish() {
  impl_->session->finish();
}

std::int64_t Filters::samples() const {
  return impl_->samples;
}

void Filters::warm_up() {
  const sensing::GrayImage blank(impl_->size.width, impl_->size.height);
  const Target target{0, {0, 0, 16, 16}, true};
  look_at(blank);
  train(std::span(&target, 1));
  finish();
  locate(std::span(&target, 1));
  finish();
}

}  // namespace partita::tracking
