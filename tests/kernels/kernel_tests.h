// What every task's kernel test is made of: each spec, in each variant, against its golden
// reference, over all its shapes, on the first OpenCL device that takes source.
#ifndef PARTITA_TESTS_KERNELS_KERNEL_TESTS_H
#define PARTITA_TESTS_KERNELS_KERNEL_TESTS_H

#include <gtest/gtest.h>

#include "host/runtime/checker.h"
#include "host/runtime/device.h"
#include "host/runtime/session.h"

namespace partita::tests {

inline runtime::Device source_device() {
  for (const runtime::Device& device : runtime::find_devices()) {
    if (device.accepts_source) return device;
  }
  throw std::runtime_error("no OpenCL device that takes source");
}

/// Checks all `specs` in `variant`; `full` adds the large shapes to the small ones.
inline void check_variant(const runtime::Session::Specs& specs, runtime::Variant variant,
                          bool full) {
  runtime::Session::Specs having;
  for (const runtime::KernelSpec* spec : specs) {
    if (spec->has(variant)) having.push_back(spec);
  }
  ASSERT_FALSE(having.empty());
  runtime::SessionOptions options;
  options.variant = variant;
  options.cache_folder = "-";
  const runtime::Session session(source_device(), having, options);
  for (const runtime::KernelSpec* spec : having) {
    std::vector<runtime::Shape> shapes = spec->small_shapes;
    if (full) shapes.insert(shapes.end(), spec->shapes.begin(), spec->shapes.end());
    for (std::uint32_t seed = 1; const runtime::Shape& shape : shapes) {
      const runtime::CheckResult result = runtime::check_kernel(session, *spec, shape, seed++);
      EXPECT_TRUE(result.equal) << spec->name << "." << to_string(variant) << " "
                                << shape.to_string() << ": " << result.different << " of "
                                << result.compared << " differ; " << result.first;
      EXPECT_GT(result.compared, 0u) << spec->name << " has no output";
    }
  }
}

}  // namespace partita::tests

#endif  // PARTITA_TESTS_KERNELS_KERNEL_TESTS_H
