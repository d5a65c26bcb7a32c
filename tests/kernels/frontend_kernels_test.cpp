// The front-end's kernels against their golden references, in every variant. The *Small* cases are
// what runs under Oclgrind.
#include "host/tasks/frontend/kernels.h"
#include "tests/kernels/kernel_tests.h"

namespace {

using partita::frontend::kernel_specs;
using partita::runtime::Variant;
using partita::tests::check_variant;

TEST(FrontendKernels, CpuSmall) {
  check_variant(kernel_specs(), Variant::cpu, false);
}
TEST(FrontendKernels, GpuSmall) {
  check_variant(kernel_specs(), Variant::gpu, false);
}
TEST(FrontendKernels, FpgaSmall) {
  check_variant(kernel_specs(), Variant::fpga, false);
}
TEST(FrontendKernels, Cpu) {
  check_variant(kernel_specs(), Variant::cpu, true);
}
TEST(FrontendKernels, Gpu) {
  check_variant(kernel_specs(), Variant::gpu, true);
}
TEST(FrontendKernels, Fpga) {
  check_variant(kernel_specs(), Variant::fpga, true);
}

}  // namespace
