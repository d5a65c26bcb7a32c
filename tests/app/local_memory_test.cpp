// The local memory that specs declare for their GPU variants is what the compiler finds in them.
#include <gtest/gtest.h>

#include "host/runtime/session.h"
#include "host/tasks/registry.h"

namespace partita::app {
namespace {

TEST(LocalMemory, IsDeclaredAsTheGpuVariantHasIt) {
  const runtime::Device device = runtime::find_devices().front();
  const auto specs = tasks::kernels_of({}, runtime::Variant::gpu);
  runtime::SessionOptions options;
  options.variant = runtime::Variant::gpu;
  const runtime::Session session(device, specs, options);
  for (const runtime::KernelSpec* spec : specs) {
    const auto bytes =
        session.make_kernel(*spec).getWorkGroupInfo<CL_KERNEL_LOCAL_MEM_SIZE>(device.cl);
    EXPECT_EQ(spec->gpu_local_bytes, bytes) << spec->task << " " << spec->name;
  }
}

}  // namespace
}  // namespace partita::app
