// partita devices: what OpenCL devices a machine shows, real or emulated.
#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/runtime/device.h"

namespace partita::app {
namespace {

Json describe(const runtime::Device& device) {
  Json item;
  item["kind"] = runtime::kind_of(device);
  item["device"] = device.name;
  item["platform"] = device.platform_name;
  item["node"] = device.node;
  item["emulated"] = device.emulated();
  item["profile"] = device.profile;
  item["compute_units"] = device.cl.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  item["max_work_group"] = device.max_work_group;
  item["local_memory_bytes"] = device.local_memory;
  item["global_memory_bytes"] = device.global_memory;
  item["takes"] = device.accepts_source ? "source" : "container";
  item["doubles"] = device.doubles;
  item["images"] = device.cl.getInfo<CL_DEVICE_IMAGE_SUPPORT>() != CL_FALSE;
  item["driver"] = device.driver_version;
  return item;
}

int devices(const std::string& machine, const Console& console) {
  set_emulation({.machine = machine});
  Table table({"kind", "device", "platform", "node", "emulated", "units", "work-group", "local",
               "global", "takes", "doubles"});
  Json list = Json::array();
  for (const runtime::Device& device : runtime::find_devices()) {
    Json item = describe(device);
    const auto bytes = [&item](const char* key) { return format_bytes(item[key].get<double>()); };
    const std::string group =
        device.max_work_group >= 0xFFFFFFFFu ? "any" : std::to_string(device.max_work_group);
    table.add({item["kind"], item["device"], item["platform"],
               device.node.empty() ? "-" : device.node,
               device.emulated() ? "from " + device.profile : "no (real)",
               item["compute_units"].dump(), group, bytes("local_memory_bytes"),
               bytes("global_memory_bytes"), item["takes"], device.doubles ? "yes" : "no"});
    list.push_back(std::move(item));
  }
  Json document;
  document["machine"] = machine;
  document["devices"] = std::move(list);
  console.result(fmt::format("Machine {}\n{}", machine, table.to_string(console.colour())),
                 document);
  return exit_ok;
}

}  // namespace

void add_devices(CLI::App& app, Context& context) {
  CLI::App* command =
      add_subcommand(app, context, "devices", "Show the OpenCL devices of a machine",
                     "partita devices\npartita devices --machine tx2\n"
                     "partita devices --machine native --json");
  auto machine = std::make_shared<std::string>("dragonfly");
  add_machine_option(command, *machine);
  command->callback([machine, &context] {
    context.action = [machine, &context] { return devices(*machine, context.console); };
  });
}

}  // namespace partita::app
