#include "host/tasks/depth/evaluation.h"

#include <cmath>

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::depth {
namespace {

bool known(float disparity) {
  return std::isfinite(disparity) && disparity > 0;
}

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

template <class A, class B>
void check_size(const A& image, const B& expected, const char* what) {
  if (image.width == expected.width && image.height == expected.height) return;
  throw Error(fmt::format("{} is {} x {}, expected {} x {} as the disparity map", what, image.width,
                          image.height, expected.width, expected.height));
}

}  // namespace

Evaluation& Evaluation::operator+=(const Evaluation& other) {
  with_truth += other.with_truth;
  compared += other.compared;
  over_1 += other.over_1;
  over_3 += other.over_3;
  error_sum += other.error_sum;
  return *this;
}

double Evaluation::density() const {
  return share(compared, with_truth);
}

double Evaluation::bad1_percent() const {
  return 100 * share(over_1, compared);
}

double Evaluation::bad3_percent() const {
  return 100 * share(over_3, compared);
}

double Evaluation::bad1_or_missing_percent() const {
  return 100 * share(over_1 + with_truth - compared, with_truth);
}

double Evaluation::bad3_or_missing_percent() const {
  return 100 * share(over_3 + with_truth - compared, with_truth);
}

double Evaluation::mean_error_px() const {
  return compared == 0 ? 0 : error_sum / static_cast<double>(compared);
}

Evaluation evaluate(const sensing::FloatImage& disparity, const sensing::FloatImage& truth,
                    const sensing::GrayImage* mask) {
  check_size(truth, disparity, "truth");
  if (mask != nullptr) check_size(*mask, disparity, "mask");
  Evaluation sums;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    if (!known(truth.pixels[i]) || (mask != nullptr && mask->pixels[i] == 0)) continue;
    ++sums.with_truth;
    if (!known(disparity.pixels[i])) continue;
    ++sums.compared;
    const double error =
        std::abs(static_cast<double>(disparity.pixels[i]) - static_cast<double>(truth.pixels[i]));
    sums.error_sum += error;
    sums.over_1 += error > 1 ? 1 : 0;
    sums.over_3 += error > 3 ? 1 : 0;
  }
  return sums;
}

}  // namespace partita::depth
