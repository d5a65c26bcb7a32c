// Golden references of the tracking kernels: plain C++, one value at a time, no cleverness. The
// kernels of all variants must give exactly these numbers: what is not an integer is one fixed
// sequence of fma, sums, differences and products, without contraction.
//
// A target is seen through patches: a square window of the picture, resampled to P x P pixels, P =
// 4 N. Planes have N x N entries, one per cell of 4 x 4 pixels. Spectra are planes in the order
// that the transforms leave them in: transposed, and both frequencies bit-reversed; whatever is
// done to them is done entry by entry, so that order never matters. A spectrum is its real plane,
// then its imaginary plane.
#ifndef PARTITA_HOST_TASKS_TRACKING_GOLDEN_H
#define PARTITA_HOST_TASKS_TRACKING_GOLDEN_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace partita::tracking {

inline constexpr int kCell = 4;           ///< side of a cell, px of the patch
inline constexpr int kDirections = 9;     ///< unsigned directions, 20 degrees each
inline constexpr int kBins = 18;          ///< signed directions
inline constexpr int kChannels = 31;      ///< 18 signed, 9 unsigned, 4 textures
inline constexpr int kPatchBits = 4;      ///< fractional bits of a patch's grey levels
inline constexpr int kWindowEntries = 5;  ///< x, y, step x, step y, log2 of the taps
inline constexpr int kPeakEntries = 6;    ///< value, place, and its four neighbours

/// cos and sin of the nine directions, times 128.
inline constexpr std::array<int, kDirections> kCosines{128, 120, 98, 64, 22, -22, -64, -98, -120};
inline constexpr std::array<int, kDirections> kSines{0, 44, 82, 111, 126, 126, 111, 82, 44};
/// Weights of the eight pixels across which a cell collects, in eighths.
inline constexpr std::array<int, 8> kWeights{1, 3, 5, 7, 7, 5, 3, 1};
/// Added to a block's energy, so that noise of about a quarter of a grey level is not amplified.
inline constexpr float kEnergyFloor = 3e8f;

struct Picture {
  int width = 0;
  int height = 0;
};

/// `windows`: per patch the position of the first sample's centre (x, y) and the pitch of the
/// samples (x, y), px in 16.16; and t: a sample is the mean of 2^t x 2^t bilinear ones, spread
/// evenly. Positions outside the picture see its edge. Patches have kPatchBits fractional bits.
void golden_resample(Picture size, std::span<const std::uint8_t> image,
                     std::span<const std::int32_t> windows, int side,
                     std::span<std::uint16_t> patches);

/// Histograms of gradient directions, [patch][bin][cell]: a pixel votes for the direction on which
/// its gradient's projection is longest, with that length, in up to four cells (Felzenszwalb et
/// al., "Object Detection with Discriminatively Trained Part-Based Models", TPAMI 2010).
void golden_cell_histograms(std::span<const std::uint16_t> patches, int cells,
                            std::span<std::int32_t> histograms);

/// 31 channels, [patch][channel][cell]: histograms normalised by four blocks of 2 x 2 cells, cut
/// off at 0.2 and summed, as there; times the window `taper` in both directions.
void golden_cell_features(std::span<const std::int32_t> histograms, std::span<const float> taper,
                          int cells, std::span<float> features);

/// Spectra of real planes. `twiddles`: cos, then sin, of 2 pi j / N for j < N / 2.
void golden_spectra(std::span<const float> planes, std::span<const float> twiddles, int cells,
                    std::span<float> spectra);

/// Spectrum of the Gaussian kernel between each patch and the model of its target, for all shifts:
/// exp(-(|x|^2 + |z|^2 - 2 x*z) `falloff`), a plane per patch (Henriques et al., "High-Speed
/// Tracking with Kernelized Correlation Filters", TPAMI 2015, equation 31). Patches of a target
/// follow each other, `scales` of them; `slots` says where each target's model lies.
void golden_correlate(std::span<const float> models, std::span<const float> spectra,
                      std::span<const std::int32_t> slots, std::span<const float> twiddles,
                      int cells, int scales, float falloff, std::span<float> kernels);

/// The filter's response to each patch (equation 22), of which only the largest value, its place,
/// and the values left, right, above and below it (cyclically) are kept, as floats.
void golden_respond(std::span<const float> kernels, std::span<const float> filters,
                    std::span<const std::int32_t> slots, std::span<const float> twiddles, int cells,
                    int scales, std::span<float> peaks);

/// Coefficients label / (kernel + `regularisation`) (equation 17); model and filter in the target's
/// slot move towards the new ones by `rates`, one per target; 1 replaces them.
void golden_train(std::span<const float> kernels, std::span<const float> spectra,
                  std::span<const float> label, std::span<const std::int32_t> slots,
                  std::span<const float> rates, float regularisation, int cells,
                  std::span<float> filters, std::span<float> models);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_GOLDEN_H
