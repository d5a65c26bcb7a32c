// partita package: an FPGA's container, our stand-in for the vendor's synthesis.
#include <filesystem>

#include <fmt/format.h>

#include "devices/model/area.h"
#include "devices/profile/machine.h"
#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/packager.h"
#include "host/io/file.h"

namespace partita::app {
namespace {

struct Options {
  std::string device = "zcu102";
  std::string model = "own";
  PackageOptions package;
  std::string out;
  bool overfull = false;
};

profile::DeviceProfile load_profile(const std::string& what) {
  namespace fs = std::filesystem;
  if (what.find('/') != std::string::npos || what.ends_with(".yaml")) {
    return profile::load_device(what);
  }
  const fs::path file = fs::path(places().profiles) / "devices" / (what + ".yaml");
  std::error_code code;
  if (!fs::exists(file, code)) {
    std::string known;
    for (const std::string& name : profile::list_devices(places().profiles)) {
      known += (known.empty() ? "" : ", ") + name;
    }
    throw Error(
        fmt::format("no device profile '{}', expected a .yaml file or one of {}", what, known));
  }
  return profile::load_device(file.string());
}

Json area_json(const profile::Area& area) {
  return {{"lut", area.lut},
          {"ff", area.ff},
          {"bram36", area.bram36},
          {"uram", area.uram},
          {"dsp", area.dsp}};
}

void add_area(Table& table, const std::string& name, const profile::Area& area) {
  table.add({name, std::to_string(area.lut), std::to_string(area.ff), std::to_string(area.bram36),
             std::to_string(area.uram), std::to_string(area.dsp)});
}

std::string share(std::uint64_t used, std::uint64_t available) {
  if (available == 0) return used == 0 ? "-" : "none there";
  return fmt::format("{:.0f} %",
                     100.0 * static_cast<double>(used) / static_cast<double>(available));
}

int package(Options options, const Console& console) {
  const profile::DeviceProfile device = load_profile(options.device);
  options.package.model = options.model == "own" ? runtime::Execute::own : runtime::Execute::fast;
  const layer::Container container = make_container(device, options.package);
  const std::string misfit = model::misfit(container.area, device);
  if (!misfit.empty() && !options.overfull) {
    throw Error(fmt::format("{}: the design does not fit: {} (--overfull packages it all the same)",
                            device.id, misfit));
  }
  io::write_file(options.out, layer::serialize(container));

  Table table({"kernel", "LUT", "FF", "BRAM36", "URAM", "DSP"});
  Json kernels = Json::array();
  for (const layer::ContainerKernel& kernel : container.kernels) {
    add_area(table, kernel.name, kernel.area);
    kernels.push_back({{"name", kernel.name}, {"area", area_json(kernel.area)}});
  }
  const profile::Area& used = container.area;
  const profile::Area& there = device.fabric.area;
  add_area(table, "all", used);
  add_area(table, device.id, there);
  table.add({"used", share(used.lut, there.lut), share(used.ff, there.ff),
             share(used.bram36, there.bram36), share(used.uram, there.uram),
             share(used.dsp, there.dsp)});
  Json document;
  document["file"] = options.out;
  document["device"] = device.id;
  document["model"] = options.model;
  document["clock_mhz"] = container.clock_mhz;
  document["kernels"] = std::move(kernels);
  document["area"] = area_json(used);
  document["available"] = area_json(there);
  document["fits"] = misfit.empty();
  const std::string verdict =
      misfit.empty() ? console.paint(Colour::green, "fits " + device.id)
                     : console.paint(Colour::red, "does not fit " + device.id) + ": " + misfit;
  console.result(
      fmt::format("{}Estimated area; {} at {:g} MHz.\n{}\n", table.to_string(console.colour()),
                  verdict, container.clock_mhz, options.out),
      document);
  return exit_ok;
}

}  // namespace

void add_package(CLI::App& app, Context& context) {
  CLI::App* command =
      add_subcommand(app, context, "package",
                     "Build an FPGA's container (stand-in for an xclbin) from the kernels",
                     "partita package --device-profile zcu102 -o zcu102.fpgabin\n"
                     "partita package --tasks frontend --model fast -o frontend.fpgabin");
  auto options = std::make_shared<Options>();
  command
      ->add_option("-d,--device-profile", options->device, "FPGA profile: a name or a .yaml file")
      ->capture_default_str();
  command
      ->add_option("--model", options->model,
                   "Text that computes the results: own (the .fpga.cl) or fast (the equal .cpu.cl)")
      ->check(CLI::IsMember({"own", "fast"}))
      ->capture_default_str();
  command->add_option("--tasks", options->package.tasks, "Tasks, by commas (default: all)")
      ->delimiter(',');
  command->add_option("-o,--out", options->out, "Container to write")->required();
  command->add_flag("--overfull", options->overfull, "Also package what does not fit the device");
  command->callback([options, &context] {
    context.action = [options, &context] { return package(*options, context.console); };
  });
}

}  // namespace partita::app
