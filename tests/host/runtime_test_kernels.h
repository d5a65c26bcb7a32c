// A kernel spec for testing the runtime itself: the bench's tiny kernel, which adds one to a
// number.
#ifndef PARTITA_TESTS_HOST_RUNTIME_TEST_KERNELS_H
#define PARTITA_TESTS_HOST_RUNTIME_TEST_KERNELS_H

#include <stdexcept>

#include "host/runtime/device.h"
#include "host/runtime/kernel_spec.h"

namespace partita::tests {

inline runtime::KernelSpec adding_spec() {
  using namespace runtime;
  KernelSpec spec;
  spec.name = "tiny";
  spec.task = "bench";
  spec.source = "tiny";
  spec.variants = {Variant::cpu, Variant::gpu};
  spec.args = {{"count", Access::inout, ElementType::u32}};
  spec.geometry = [](Variant, const Shape&) { return LaunchGeometry{}; };
  spec.work = [](Variant, const Shape&) { return Work{}; };
  spec.make_case = [](const Shape& shape, std::uint32_t seed) {
    return KernelCase{shape, {HostArray::of<std::uint32_t>(ElementType::u32, std::array{seed})}};
  };
  spec.golden = [](KernelCase& c) { c.args[0].as<std::uint32_t>()[0] += 1; };
  return spec;
}

inline runtime::Device first_source_device() {
  for (const runtime::Device& device : runtime::find_devices()) {
    if (device.accepts_source) return device;
  }
  throw std::runtime_error("no OpenCL device that takes source");
}

}  // namespace partita::tests

#endif  // PARTITA_TESTS_HOST_RUNTIME_TEST_KERNELS_H
