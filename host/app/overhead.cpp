#include "host/app/overhead.h"

#include <algorithm>
#include <cmath>

#include "host/app/wall_clock.h"
#include "host/runtime/kernel.h"

namespace partita::app {
namespace {

using runtime::Access;
using runtime::ElementType;
using runtime::Shape;
using runtime::Variant;

const runtime::KernelSpec& tiny_spec() {
  static const runtime::KernelSpec spec = [] {
    runtime::KernelSpec s;
    s.name = "tiny";
    s.task = "bench";
    s.source = "tiny";
    s.variants = {Variant::cpu, Variant::gpu};
    s.args = {{"count", Access::inout, ElementType::u32}};
    s.geometry = [](Variant, const Shape&) { return runtime::LaunchGeometry{}; };
    s.work = [](Variant, const Shape&) {
      Work work;
      work[OpClass::int_add] = 1;
      work.read_issued = work.written_issued = 4;
      work.read_unique = work.written_unique = 4;
      return work;
    };
    return s;
  }();
  return spec;
}

/// One open device with the tiny kernel, and how to launch it without our runtime.
class Bench {
 public:
  explicit Bench(const runtime::Device& device)
      : session_(device, {&tiny_spec()}, {}),
        kernel_(session_, tiny_spec()),
        raw_kernel_(session_.make_kernel(tiny_spec())),
        count_(session_.make_buffer(sizeof(cl_uint))) {
    const cl_uint zero = 0;
    session_.write(count_, std::as_bytes(std::span(&zero, 1)));
    session_.finish();
    raw(1);  // the first launch compiles
    framework(1);
  }

  Batch raw(std::size_t commands) {
    const bool declares = session_.extension().present();
    const Work work = tiny_spec().work(Variant::cpu, {});
    const cl_mem memory = count_();
    const std::size_t one[3] = {1, 1, 1};
    const std::uint64_t start = wall_now();
    for (std::size_t i = 0; i < commands; ++i) {
      clSetKernelArg(raw_kernel_(), 0, sizeof memory, &memory);
      if (declares) session_.extension().set_work(session_.queue(), work);
      clEnqueueNDRangeKernel(session_.queue()(), raw_kernel_(), 3, nullptr, one, one, 0, nullptr,
                             nullptr);
    }
    return finished(start, commands);
  }

  Batch framework(std::size_t commands) {
    const std::uint64_t start = wall_now();
    for (std::size_t i = 0; i < commands; ++i) kernel_.launch({{"items", 1}}, count_);
    return finished(start, commands);
  }

 private:
  Batch finished(std::uint64_t start, std::size_t commands) const {
    const std::uint64_t called = wall_now();
    session_.finish();
    const auto count = static_cast<double>(commands);
    return {static_cast<double>(called - start) / count,
            static_cast<double>(wall_now() - start) / count};
  }

  runtime::Session session_;
  runtime::Kernel kernel_;
  cl::Kernel raw_kernel_;
  cl::Buffer count_;
};

}  // namespace

std::vector<Batch> raw_launches(const runtime::Device& device, const Batches& size) {
  Bench bench(device);
  std::vector<Batch> times;
  for (std::size_t i = 0; i < size.batches; ++i) times.push_back(bench.raw(size.commands));
  return times;
}

Pair raw_and_framework_launches(const runtime::Device& device, const Batches& size) {
  Bench bench(device);
  Pair pair;
  for (std::size_t i = 0; i < size.batches; ++i) {
    pair.raw.push_back(bench.raw(size.commands));
    pair.framework.push_back(bench.framework(size.commands));
  }
  return pair;
}

Quartiles quartiles(const std::vector<Batch>& batches, double Batch::*figure) {
  std::vector<double> values;
  for (const Batch& batch : batches) values.push_back(batch.*figure);
  std::sort(values.begin(), values.end());
  const auto quarter = [&values](std::size_t n) { return values[(values.size() - 1) * n / 4]; };
  return {quarter(1), quarter(2), quarter(3)};
}

bool below_noise(const Quartiles& a, const Quartiles& b) {
  return std::abs(a.median - b.median) <= std::max(a.range(), b.range());
}

}  // namespace partita::app
