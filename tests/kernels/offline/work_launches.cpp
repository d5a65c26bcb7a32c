// Launches every kernel once per variant on its first small shape and prints the Work that its spec
// declares for the launch, one JSON object per line. check_work runs it under Oclgrind's instruction
// counters and holds the one against the other.
#include <cstdio>

#include <fmt/format.h>

#include "host/runtime/checker.h"
#include "host/tasks/registry.h"
#include "tests/kernels/kernel_tests.h"

namespace {

void launch(const partita::runtime::KernelSpec& spec, partita::runtime::Variant variant) {
  using partita::OpClass;
  partita::runtime::SessionOptions options;
  options.variant = variant;
  options.cache_folder = "-";
  const partita::runtime::Session session(partita::tests::source_device(), {&spec}, options);
  for (const partita::runtime::Shape& shape : spec.small_shapes) {
    const auto input = spec.make_case(shape, 1);
    const partita::Work work = spec.work(variant, input.shape);
    const std::uint64_t int_ops =
        work[OpClass::int_add] + work[OpClass::int_mul] + work[OpClass::int_special];
    const std::uint64_t float_ops = work[OpClass::float_add] + work[OpClass::float_mul] +
                                    work[OpClass::float_fma] + work[OpClass::float_special] +
                                    work[OpClass::double_add] + work[OpClass::double_mul] +
                                    work[OpClass::double_fma] + work[OpClass::double_special];
    fmt::print("LAUNCH {{\"kernel\": \"{}\", \"variant\": \"{}\", \"shape\": \"{}\", ", spec.name,
               to_string(variant), shape.to_string());
    fmt::print("\"read\": {}, \"written\": {}, \"int_ops\": {}, \"float_ops\": {}}}\n",
               work.read_issued, work.written_issued, int_ops, float_ops);
    std::fflush(stdout);
    if (!check_kernel(session, spec, shape, 1).equal) fmt::print("MISMATCH {}\n", spec.name);
    std::fflush(stdout);
  }
}

}  // namespace

int main() {
  for (const auto& task : partita::tasks::all_tasks()) {
    for (const auto* spec : task.kernels) {
      for (const auto variant : spec->variants) launch(*spec, variant);
    }
  }
}
