#include "host/app/roofline.h"

#include <algorithm>

#include "host/app/wall_clock.h"
#include "host/runtime/kernel.h"

namespace partita::app {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::KernelSpec;
using runtime::Shape;
using runtime::Variant;

constexpr std::size_t kItems = 64, kCopied = std::size_t{1} << 20;  // numbers of a work-item
constexpr int kFmaRounds = 200'000, kRounds = 5;
constexpr double kFmaChains = 12 * 16;  // as kernels/bench/peak.cl has them

KernelSpec peak_spec(const char* name) {
  KernelSpec spec;
  spec.name = name;
  spec.task = "bench";
  spec.source = "peak";
  spec.variants = {Variant::cpu, Variant::gpu};
  spec.geometry = [](Variant, const Shape&) {
    return runtime::LaunchGeometry{{kItems, 1, 1}, {1, 1, 1}};
  };
  spec.work = [](Variant, const Shape&) { return Work{}; };
  return spec;
}

const KernelSpec& fma_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = peak_spec("peak_fma");
    s.args = {{"out", Access::out, ElementType::f32},
              {"factor", Access::scalar, ElementType::f32},
              {"rounds", Access::scalar, ElementType::i32}};
    return s;
  }();
  return spec;
}

const KernelSpec& copy_spec() {
  static const KernelSpec spec = [] {
    KernelSpec s = peak_spec("peak_copy");
    s.args = {{"in", Access::in, ElementType::f32},
              {"out", Access::out, ElementType::f32},
              {"numbers", Access::scalar, ElementType::i32}};
    return s;
  }();
  return spec;
}

/// Seconds of the quickest of a few launches after one to warm up.
template <typename Launch>
double best_seconds(const runtime::Session& session, const Launch& launch) {
  double best = 0;
  for (int round = 0; round <= kRounds; ++round) {
    const std::uint64_t start = wall_now();
    launch();
    session.finish();
    const double seconds = static_cast<double>(wall_now() - start) * 1e-9;
    if (round == 1 || (round > 1 && seconds < best)) best = seconds;
  }
  return best;
}

}  // namespace

Roofline measure_roofline(const runtime::Device& device) {
  const runtime::Session session(device, {&fma_spec(), &copy_spec()}, {.variant = Variant::cpu});
  const std::size_t bytes = kItems * kCopied / 4 * sizeof(float);
  const cl::Buffer from = session.make_buffer(bytes), to = session.make_buffer(bytes);
  runtime::Kernel fma(session, fma_spec()), copy(session, copy_spec());
  const double computing =
      best_seconds(session, [&] { fma.launch({}, to, cl_float{0.5F}, cl_int{kFmaRounds}); });
  const double copying =
      best_seconds(session, [&] { copy.launch({}, from, to, static_cast<cl_int>(kCopied / 4)); });
  return {2.0 * kFmaChains * kFmaRounds * static_cast<double>(kItems) / computing,
          2.0 * static_cast<double>(bytes) / copying};
}

}  // namespace partita::app
