// Every detection kernel in every variant against its golden reference. The *Small* cases run under
// Oclgrind as well.
#include <gtest/gtest.h>

#include "host/tasks/detection/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::tests {
namespace {

using runtime::Variant;

TEST(DetectionKernelsSmall, Cpu) {
  check_variant(detection::kernel_specs(), Variant::cpu, false);
}
TEST(DetectionKernelsSmall, Gpu) {
  check_variant(detection::kernel_specs(), Variant::gpu, false);
}
TEST(DetectionKernelsSmall, Fpga) {
  check_variant(detection::kernel_specs(), Variant::fpga, false);
}

TEST(DetectionKernels, CpuAllShapes) {
  check_variant(detection::kernel_specs(), Variant::cpu, true);
}
TEST(DetectionKernels, GpuAllShapes) {
  check_variant(detection::kernel_specs(), Variant::gpu, true);
}
TEST(DetectionKernels, FpgaAllShapes) {
  check_variant(detection::kernel_specs(), Variant::fpga, true);
}

}  // namespace
}  // namespace partita::tests
