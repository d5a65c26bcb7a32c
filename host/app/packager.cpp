#include "host/app/packager.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "devices/model/area.h"
#include "devices/profile/machine.h"
#include "host/app/environment.h"
#include "host/app/text_sections.h"
#include "host/io/file.h"
#include "host/runtime/error.h"
#include "host/runtime/program.h"
#include "host/runtime/sources.h"
#include "host/tasks/registry.h"

namespace partita::app {
namespace {

using runtime::Access;
using runtime::KernelSpec;
using runtime::Variant;

layer::ContainerArg describe(const runtime::ArgSpec& arg) {
  const std::string type(runtime::to_string(arg.type));
  if (arg.access == Access::scalar) return {arg.name, type, "private"};
  return {arg.name, type + "*", arg.access == Access::local ? "local" : "global"};
}

layer::ContainerKernel describe(const KernelSpec& spec, Variant text) {
  layer::ContainerKernel kernel;
  kernel.name = spec.name;
  for (const runtime::ArgSpec& arg : spec.args) kernel.args.push_back(describe(arg));
  // Loops and local size are the circuit's own, whatever the shape; a case knows its counts.
  const runtime::Shape shape = spec.make_case(spec.small_shapes.back(), 1).shape;
  const Work work = spec.work(Variant::fpga, shape);
  for (std::uint32_t i = 0; i < work.loop_count; ++i) {
    kernel.loops.push_back({fmt::format("loop{}", i), work.loops[i].ii, work.loops[i].depth});
  }
  const auto local = spec.geometry(text, shape).local;
  std::copy(local.begin(), local.end(), kernel.work_group.begin());
  kernel.design = spec.design;
  kernel.area = model::estimate_area(spec.design);
  return kernel;
}

}  // namespace

layer::Container make_container(const profile::DeviceProfile& device,
                                const PackageOptions& options) {
  if (device.type != profile::DeviceType::fpga) {
    throw Error(fmt::format("{}: is no FPGA, so it takes no container", device.path));
  }
  auto specs = options.kernels;
  if (specs.empty()) {
    specs = options.tasks.empty() ? tasks::vehicle_kernels()
                                  : tasks::kernels_of(options.tasks, Variant::fpga);
  }
  if (specs.empty()) throw Error("package: the chosen tasks have no FPGA kernel");
  const Variant text = options.model == runtime::Execute::own ? Variant::fpga : Variant::cpu;

  layer::Container container;
  container.device = device.id;
  container.clock_mhz = device.performance.clock_hz / 1e6;
  container.build_options = "-cl-std=CL1.2";
  std::map<std::string, TextSection> sections;
  for (const KernelSpec* spec : specs) {
    const std::string file(runtime::kernel_file(*spec, text));
    sections[file + " " + spec->options] = {file, runtime::flattened_source(file), spec->options};
    container.kernels.push_back(describe(*spec, text));
    container.area = model::operator+(container.area, container.kernels.back().area);
  }
  std::vector<TextSection> ordered;
  for (auto& [key, section] : sections) ordered.push_back(std::move(section));
  container.text = join_sections(ordered);
  return container;
}

std::string container_name(const std::string& profile, runtime::Execute model) {
  return fmt::format("{}.{}.fpgabin", profile, runtime::to_string(model));
}

std::string container_for(const profile::DeviceProfile& device, runtime::Execute model,
                          const std::vector<const KernelSpec*>& kernels) {
  namespace fs = std::filesystem;
  const layer::Container wanted = make_container(device, {.kernels = kernels, .model = model});
  if (const std::string misfit = model::misfit(wanted.area, device); !misfit.empty()) {
    throw Error(fmt::format("{}: the kernels do not fit: {}", device.path, misfit));
  }
  const std::string bytes = layer::serialize(wanted);
  const std::string name = container_name(device.id, model);
  std::error_code code;
  if (!places().containers.empty()) {
    const fs::path built = fs::path(places().containers) / name;
    if (fs::exists(built, code) && io::read_file(built.string()) == bytes) return built.string();
  }
  const std::string cache = runtime::user_cache_folder();
  if (cache.empty()) {
    throw Error(
        fmt::format("{}: not packaged yet, and there is no cache folder to put it into: "
                    "set XDG_CACHE_HOME",
                    name));
  }
  const std::string path = fmt::format("{}/{}.{}", cache, profile::hash_bytes(bytes), name);
  if (!fs::exists(path, code)) io::write_file(path, bytes);
  return path;
}

std::string container_for(const runtime::Device& device, const std::string& machine,
                          runtime::Execute model, const std::string& given,
                          const std::vector<const KernelSpec*>& kernels) {
  if (!given.empty()) return given;
  if (!device.emulated()) {
    throw Error(fmt::format("{}: takes no source: name its container (an xclbin) with --container",
                            device.name));
  }
  for (const profile::MachineDevice& candidate :
       profile::load_machine(machine, places().profiles).devices) {
    if (candidate.profile.id == device.profile)
      return container_for(candidate.profile, model, kernels);
  }
  throw Error(
      fmt::format("{}: machine {} has no profile {}", device.name, machine, device.profile));
}

}  // namespace partita::app
