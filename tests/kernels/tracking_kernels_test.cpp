// Every tracking kernel in every variant against its golden reference. The *Small* cases run under
// Oclgrind as well.
#include <gtest/gtest.h>

#include "host/tasks/tracking/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::tests {
namespace {

using runtime::Variant;

TEST(TrackingKernelsSmall, Cpu) {
  check_variant(tracking::kernel_specs(), Variant::cpu, false);
}
TEST(TrackingKernelsSmall, Gpu) {
  check_variant(tracking::kernel_specs(), Variant::gpu, false);
}
TEST(TrackingKernelsSmall, Fpga) {
  check_variant(tracking::kernel_specs(), Variant::fpga, false);
}

TEST(TrackingKernels, CpuAllShapes) {
  check_variant(tracking::kernel_specs(), Variant::cpu, true);
}
TEST(TrackingKernels, GpuAllShapes) {
  check_variant(tracking::kernel_specs(), Variant::gpu, true);
}
TEST(TrackingKernels, FpgaAllShapes) {
  check_variant(tracking::kernel_specs(), Variant::fpga, true);
}

}  // namespace
}  // namespace partita::tests
