#include <cmath>
#include <complex>
#include <vector>

#include "host/tasks/tracking/golden.h"
#include "host/tasks/tracking/golden_math.h"

namespace partita::tracking {
namespace {

/// A plane of complex numbers, as a spectrum is stored.
struct Plane {
  explicit Plane(int n) : cells(n), re(plane_size(n)), im(plane_size(n)) {}
  int cells;
  std::vector<float> re, im;
};

/// The butterflies of one column (elements `x + N k`), decimation in frequency: from natural to
/// bit-reversed order.
void forward_column(Plane& plane, std::span<const float> twiddles, int x) {
  const int n = plane.cells;
  for (int half = n / 2; half >= 1; half /= 2) {
    for (int block = 0; block < n; block += 2 * half) {
      for (int j = 0; j < half; ++j) {
        const auto a = static_cast<std::size_t>((block + j) * n + x);
        const auto b = a + static_cast<std::size_t>(half * n);
        const auto t = static_cast<std::size_t>(j * (n / (2 * half)));
        const float c = twiddles[t];
        const float s = twiddles[t + static_cast<std::size_t>(n / 2)];
        const float re = plane.re[a] - plane.re[b];
        const float im = plane.im[a] - plane.im[b];
        plane.re[a] = plane.re[a] + plane.re[b];
        plane.im[a] = plane.im[a] + plane.im[b];
        plane.re[b] = std::fma(re, c, im * s);
        plane.im[b] = std::fma(im, c, -(re * s));
      }
    }
  }
}

/// And back, decimation in time, without the division by N.
void inverse_column(Plane& plane, std::span<const float> twiddles, int x) {
  const int n = plane.cells;
  for (int half = 1; half < n; half *= 2) {
    for (int block = 0; block < n; block += 2 * half) {
      for (int j = 0; j < half; ++j) {
        const auto a = static_cast<std::size_t>((block + j) * n + x);
        const auto b = a + static_cast<std::size_t>(half * n);
        const auto t = static_cast<std::size_t>(j * (n / (2 * half)));
        const float c = twiddles[t];
        const float s = twiddles[t + static_cast<std::size_t>(n / 2)];
        const float re = std::fma(plane.re[b], c, -(plane.im[b] * s));
        const float im = std::fma(plane.im[b], c, plane.re[b] * s);
        plane.re[b] = plane.re[a] - re;
        plane.im[b] = plane.im[a] - im;
        plane.re[a] = plane.re[a] + re;
        plane.im[a] = plane.im[a] + im;
      }
    }
  }
}

void transpose(Plane& plane) {
  for (int y = 0; y < plane.cells; ++y) {
    for (int x = 0; x < y; ++x) {
      const auto a = static_cast<std::size_t>(y * plane.cells + x);
      const auto b = static_cast<std::size_t>(x * plane.cells + y);
      std::swap(plane.re[a], plane.re[b]);
      std::swap(plane.im[a], plane.im[b]);
    }
  }
}

void forward(Plane& plane, std::span<const float> twiddles) {
  for (int x = 0; x < plane.cells; ++x) forward_column(plane, twiddles, x);
  transpose(plane);
  for (int x = 0; x < plane.cells; ++x) forward_column(plane, twiddles, x);
}

void inverse(Plane& plane, std::span<const float> twiddles) {
  for (int x = 0; x < plane.cells; ++x) inverse_column(plane, twiddles, x);
  transpose(plane);
  for (int x = 0; x < plane.cells; ++x) inverse_column(plane, twiddles, x);
}

/// The sum of all entries, halves onto halves: an order that a tree of adders has too.
float tree_sum(std::vector<float> values) {
  for (std::size_t half = values.size() / 2; half >= 1; half /= 2) {
    for (std::size_t i = 0; i < half; ++i) values[i] = values[i] + values[i + half];
  }
  return values[0];
}

float over_plane(int cells) {
  return 1.0f / static_cast<float>(plane_size(cells));  // a power of two: exact
}

void store(const Plane& plane, std::span<float> spectra, std::size_t index) {
  const std::size_t size = plane.re.size();
  for (std::size_t i = 0; i < size; ++i) {
    spectra[2 * index * size + i] = plane.re[i];
    spectra[(2 * index + 1) * size + i] = plane.im[i];
  }
}

}  // namespace

void golden_spectra(std::span<const float> planes, std::span<const float> twiddles, int cells,
                    std::span<float> spectra) {
  const std::size_t size = plane_size(cells);
  for (std::size_t p = 0; p < planes.size() / size; ++p) {
    Plane plane(cells);
    for (std::size_t i = 0; i < size; ++i) plane.re[i] = planes[p * size + i];
    forward(plane, twiddles);
    store(plane, spectra, p);
  }
}

void golden_correlate(std::span<const float> models, std::span<const float> spectra,
                      std::span<const std::int32_t> slots, std::span<const float> twiddles,
                      int cells, int scales, float falloff, std::span<float> kernels) {
  const std::size_t size = plane_size(cells);
  for (std::size_t p = 0; p < slots.size() * static_cast<std::size_t>(scales); ++p) {
    const auto slot = static_cast<std::size_t>(slots[p / static_cast<std::size_t>(scales)]);
    Plane plane(cells);
    std::vector<float> model_norm(size), patch_norm(size);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const float* x = &models[2 * (slot * kChannels + c) * size];
      const float* z = &spectra[2 * (p * kChannels + c) * size];
      for (std::size_t i = 0; i < size; ++i) {
        const float xr = x[i], xi = x[i + size], zr = z[i], zi = z[i + size];
        plane.re[i] = std::fma(xi, zi, std::fma(xr, zr, plane.re[i]));
        plane.im[i] = std::fma(-xi, zr, std::fma(xr, zi, plane.im[i]));
        model_norm[i] = std::fma(xi, xi, std::fma(xr, xr, model_norm[i]));
        patch_norm[i] = std::fma(zi, zi, std::fma(zr, zr, patch_norm[i]));
      }
    }
    const float norms = tree_sum(model_norm) + tree_sum(patch_norm);
    inverse(plane, twiddles);
    // Spectra are not divided by anything: norms and products carry the plane's size once more.
    const float scale = falloff * over_plane(cells);
    for (std::size_t i = 0; i < size; ++i) {
      const float distance = std::fma(-2.0f, plane.re[i], norms);
      plane.re[i] = exp_of_minus((distance > 0 ? distance : 0.0f) * scale);
      plane.im[i] = 0;
    }
    forward(plane, twiddles);
    store(plane, kernels, p);
  }
}

void golden_respond(std::span<const float> kernels, std::span<const float> filters,
                    std::span<const std::int32_t> slots, std::span<const float> twiddles, int cells,
                    int scales, std::span<float> peaks) {
  const std::size_t size = plane_size(cells);
  const auto n = static_cast<std::size_t>(cells);
  for (std::size_t p = 0; p < slots.size() * static_cast<std::size_t>(scales); ++p) {
    const auto slot = static_cast<std::size_t>(slots[p / static_cast<std::size_t>(scales)]);
    Plane plane(cells);
    for (std::size_t i = 0; i < size; ++i) {
      const float kr = kernels[2 * p * size + i];
      const float ki = kernels[(2 * p + 1) * size + i];
      const float ar = filters[2 * slot * size + i];
      const float ai = filters[(2 * slot + 1) * size + i];
      plane.re[i] = std::fma(kr, ar, -(ki * ai));
      plane.im[i] = std::fma(kr, ai, ki * ar);
    }
    inverse(plane, twiddles);
    std::size_t best = 0;
    for (std::size_t i = 1; i < size; ++i) {
      if (plane.re[i] > plane.re[best]) best = i;
    }
    const std::size_t x = best % n, y = best / n;
    const auto at = [&](std::size_t px, std::size_t py) {
      return plane.re[py % n * n + px % n] * over_plane(cells);
    };
    float* peak = &peaks[p * kPeakEntries];
    peak[0] = at(x, y);
    peak[1] = static_cast<float>(best);
    peak[2] = at(x + n - 1, y);
    peak[3] = at(x + 1, y);
    peak[4] = at(x, y + n - 1);
    peak[5] = at(x, y + 1);
  }
}

void golden_train(std::span<const float> kernels, std::span<const float> spectra,
                  std::span<const float> label, std::span<const std::int32_t> slots,
                  std::span<const float> rates, float regularisation, int cells,
                  std::span<float> filters, std::span<float> models) {
  const std::size_t size = plane_size(cells);
  for (std::size_t t = 0; t < slots.size(); ++t) {
    const auto slot = static_cast<std::size_t>(slots[t]);
    const float rate = rates[t];
    const auto move = [rate](float& old, float target) {
      old = rate < 1.0f ? std::fma(rate, target - old, old) : target;
    };
    for (std::size_t i = 0; i < size; ++i) {
      const float kr = kernels[2 * t * size + i] + regularisation;
      const float ki = kernels[(2 * t + 1) * size + i];
      const float over = reciprocal(std::fma(ki, ki, kr * kr));
      const float yr = label[i];
      const float yi = label[size + i];
      move(filters[2 * slot * size + i], std::fma(yi, ki, yr * kr) * over);
      move(filters[(2 * slot + 1) * size + i], std::fma(yi, kr, -(yr * ki)) * over);
    }
    const std::size_t values = 2 * kChannels * size;
    for (std::size_t i = 0; i < values; ++i) {
      move(models[slot * values + i], spectra[t * values + i]);
    }
  }
}

}  // namespace partita::tracking
