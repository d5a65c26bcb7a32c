#include "devices/layer/estimate.h"

#include <algorithm>
#include <cstring>
#include <dlfcn.h>
#include <string>

#include "devices/layer/estimate_plugin.h"
#include "devices/layer/program.h"
#include "devices/layer/program_text.h"

namespace partita::layer {
namespace {

/// The plugin beside the layer's own library; null if it is not there.
EstimateFn load_plugin() {
  Dl_info here{};
  if (!dladdr(reinterpret_cast<void*>(&load_plugin), &here) || !here.dli_fname) return nullptr;
  std::string path = here.dli_fname;
  path = path.substr(0, path.find_last_of('/') + 1) + kEstimateLibrary;
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    say_once(std::string("estimates: ") + dlerror());
    return nullptr;
  }
  return reinterpret_cast<EstimateFn>(dlsym(library, kEstimateFunction));
}

EstimateFn plugin() {
  static const EstimateFn function = load_plugin();
  return function;
}

/// The source, compiled and not linked. Before it gives out the binary of a built program, PoCL
/// compiles all its kernels to machine code: seconds, for kernels that may never be launched.
std::string compile_alone(cl_kernel handle, const Program& program, const std::string& given) {
  cl_context context = nullptr;
  target().clGetKernelInfo(handle, CL_KERNEL_CONTEXT, sizeof context, &context, nullptr);
  return twin_binary([&] {
    cl_int error = CL_SUCCESS;
    const cl_program twin = create_driver_program(context, program.devices, program.source, error);
    const BuildOptions options = build_options(given.c_str(), program.devices);
    if (twin) {
      target().clCompileProgram(twin, 0, nullptr, options.text.c_str(), 0, nullptr, nullptr,
                                nullptr, nullptr);
    }
    return twin;
  });
}

/// The same once for each build of the program, and a linked program's library; empty if it was
/// made of something else.
std::shared_ptr<const std::string> unlinked_binary(cl_kernel handle, Program& program) {
  std::string options;
  std::uint32_t build = 0;
  {
    const Lock lock(state().mutex);
    build = program.builds;
    if (program.unlinked && program.unlinked_build == build) return program.unlinked;
    options = program.options;
  }
  auto binary = std::make_shared<const std::string>(
      program.source.empty() ? std::string() : compile_alone(handle, program, options));
  const Lock lock(state().mutex);
  program.unlinked = binary;
  program.unlinked_build = build;
  return binary;
}

/// PoCL's binary is a list of files: length of the name, name, length, contents. The program's
/// bitcode, before the work-group loops are built around it, is "/program.bc".
std::string_view find_bitcode(const std::string& binary) {
  constexpr std::string_view kName = "/program.bc";
  const std::size_t at = binary.find(kName);
  if (at == std::string::npos || at + kName.size() + 4 > binary.size()) return {};
  std::uint32_t bytes = 0;
  std::memcpy(&bytes, binary.data() + at + kName.size(), sizeof bytes);
  const std::size_t begin = at + kName.size() + sizeof bytes;
  if (bytes > binary.size() - begin) return {};
  return std::string_view(binary).substr(begin, bytes);
}

ItemEstimate make_estimate(cl_kernel handle, const Kernel& kernel) {
  cl_program program = nullptr;
  target().clGetKernelInfo(handle, CL_KERNEL_PROGRAM, sizeof program, &program, nullptr);
  const EstimateFn estimate = plugin();
  if (program && estimate) {
    const auto unlinked = unlinked_binary(handle, *kernel.program);
    const std::string built = unlinked->empty() ? driver_binary(program) : std::string();
    const std::string_view bitcode = find_bitcode(unlinked->empty() ? built : *unlinked);
    ItemEstimate item;
    if (!bitcode.empty() && estimate(bitcode.data(), bitcode.size(), kernel.name.c_str(),
                                     kDefaultTrips, &item.per_item, &item.iterations) == 0) {
      return item;
    }
  }
  say_once("kernel '" + kernel.name +
           "': its code cannot be read, its time is a fixed guess for each work-item");
  return fallback_estimate();
}

std::uint64_t times(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 50;
  return b != 0 && a > kMost / b ? kMost : a * b;
}

}  // namespace

ItemEstimate fallback_estimate() {
  ItemEstimate item;
  item.per_item[OpClass::int_add] = 32;
  item.per_item[OpClass::float_fma] = 32;
  item.per_item.read_issued = 64;
  item.per_item.written_issued = 16;
  item.per_item.kind = WorkKind::gather;
  item.iterations = 32;
  return item;
}

std::shared_ptr<const ItemEstimate> estimate_of(cl_kernel handle, Kernel& kernel) {
  {
    const Lock lock(state().mutex);
    if (kernel.estimate) return kernel.estimate;
  }
  auto fresh = std::make_shared<const ItemEstimate>(make_estimate(handle, kernel));
  const Lock lock(state().mutex);
  if (!kernel.estimate) kernel.estimate = std::move(fresh);
  return kernel.estimate;
}

Work estimated_work(const ItemEstimate& estimate, std::uint64_t items, std::uint64_t reachable,
                    const ContainerKernel* circuit) {
  Work work;
  work.kind = estimate.per_item.kind;
  work.estimated = 1;
  for (std::size_t i = 0; i < kOpClasses; ++i) {
    work.ops[i] = times(estimate.per_item.ops[i], items);
  }
  work.read_issued = times(estimate.per_item.read_issued, items);
  work.written_issued = times(estimate.per_item.written_issued, items);
  work.local_bytes = times(estimate.per_item.local_bytes, items);
  work.read_unique = std::min(work.read_issued, reachable);
  work.written_unique = std::min(work.written_issued, reachable);
  const bool reuses = work.read_issued / 4 > work.read_unique;
  if (reuses && work.kind == WorkKind::stream) work.kind = WorkKind::dense;
  std::uint32_t depth = 100, ii = 1;
  if (circuit) {
    for (const ContainerLoop& loop : circuit->loops) {
      depth = std::max(depth, loop.depth);
      ii = std::max(ii, loop.ii);
    }
  }
  work.add_loop(times(estimate.iterations, items), ii, depth);
  return work;
}

}  // namespace partita::layer
