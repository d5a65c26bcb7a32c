// Every back-end kernel in every variant against its golden reference. The *Small* cases run under
// Oclgrind as well.
#include <gtest/gtest.h>

#include "host/tasks/backend/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace partita::tests {
namespace {

using runtime::Variant;

TEST(BackendKernelsSmall, Cpu) {
  check_variant(backend::kernel_specs(), Variant::cpu, false);
}
TEST(BackendKernelsSmall, Gpu) {
  check_variant(backend::kernel_specs(), Variant::gpu, false);
}
TEST(BackendKernelsSmall, Fpga) {
  check_variant(backend::kernel_specs(), Variant::fpga, false);
}

TEST(BackendKernels, CpuAllShapes) {
  check_variant(backend::kernel_specs(), Variant::cpu, true);
}
TEST(BackendKernels, GpuAllShapes) {
  check_variant(backend::kernel_specs(), Variant::gpu, true);
}
TEST(BackendKernels, FpgaAllShapes) {
  check_variant(backend::kernel_specs(), Variant::fpga, true);
}

}  // namespace
}  // namespace partita::tests
