// Every depth kernel in every variant against its golden reference. The *Small* cases run under
// Oclgrind as well.
#include <gtest/gtest.h>

#include "host/tasks/depth/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::tests {
namespace {

using runtime::Variant;

TEST(DepthKernelsSmall, Cpu) {
  check_variant(depth::kernel_specs(), Variant::cpu, false);
}
TEST(DepthKernelsSmall, Gpu) {
  check_variant(depth::kernel_specs(), Variant::gpu, false);
}
TEST(DepthKernelsSmall, Fpga) {
  check_variant(depth::kernel_specs(), Variant::fpga, false);
}

TEST(DepthKernels, CpuAllShapes) {
  check_variant(depth::kernel_specs(), Variant::cpu, true);
}
TEST(DepthKernels, GpuAllShapes) {
  check_variant(depth::kernel_specs(), Variant::gpu, true);
}
TEST(DepthKernels, FpgaAllShapes) {
  check_variant(depth::kernel_specs(), Variant::fpga, true);
}

}  // namespace
}  // namespace partita::tests
