// partita verify: every kernel against its golden reference, on the devices of a machine.
#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "host/app/command.h"
#include "host/app/environment.h"
#include "host/app/exit_code.h"
#include "host/app/packager.h"
#include "host/runtime/checker.h"
#include "host/runtime/device.h"
#include "host/tasks/registry.h"

namespace partita::app {
namespace {

using runtime::KernelSpec;
using runtime::Variant;

struct Options {
  std::string machine = "dragonfly";
  std::string device;
  std::string container;
  std::string variant;
  std::vector<std::string> kernels;
  bool full = false;
};

struct Row {
  const KernelSpec* spec = nullptr;
  std::size_t shapes = 0, failed = 0, compared = 0;
  double worst = 0;
  std::string first;  ///< what differed first
};

Row check(const runtime::Session& session, const KernelSpec& spec, bool full) {
  Row row{.spec = &spec, .first = {}};
  std::vector<runtime::Shape> shapes = spec.small_shapes;
  if (full) shapes.insert(shapes.end(), spec.shapes.begin(), spec.shapes.end());
  for (const runtime::Shape& shape : shapes) {
    const auto seed = static_cast<std::uint32_t>(++row.shapes);
    const runtime::CheckResult result = runtime::check_kernel(session, spec, shape, seed);
    row.compared += result.compared;
    row.worst = std::max(row.worst, result.largest_error);
    if (result.equal) continue;
    ++row.failed;
    if (row.first.empty()) row.first = fmt::format("{}: {}", shape.to_string(), result.first);
  }
  return row;
}

std::vector<const KernelSpec*> chosen_kernels(const Options& options, Variant variant) {
  std::vector<const KernelSpec*> specs = tasks::kernels_of({}, variant);
  if (options.kernels.empty()) return specs;
  std::erase_if(specs, [&](const KernelSpec* spec) {
    return std::find(options.kernels.begin(), options.kernels.end(), spec->name) ==
           options.kernels.end();
  });
  return specs;
}

/// Those of `specs` that are in `others` too.
std::vector<const KernelSpec*> common(std::vector<const KernelSpec*> specs,
                                      const std::vector<const KernelSpec*>& others) {
  std::erase_if(specs, [&others](const KernelSpec* spec) {
    return std::find(others.begin(), others.end(), spec) == others.end();
  });
  return specs;
}

void check_kernel_names(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    std::string known;
    bool found = false;
    for (const tasks::Task& task : tasks::all_tasks()) {
      for (const KernelSpec* spec : task.kernels) {
        found |= spec->name == name;
        known += (known.empty() ? "" : ", ") + spec->name;
      }
    }
    if (!found) throw Error(fmt::format("no kernel '{}', expected one of {}", name, known));
  }
}

class Verifier {
 public:
  Verifier(const Options& options, const Console& console) : options_(options), console_(console) {}

  int run() {
    check_kernel_names(options_.kernels);
    std::optional<Variant> wanted;
    if (!options_.variant.empty()) wanted = runtime::parse_variant(options_.variant);
    set_emulation({.machine = options_.machine});
    std::vector<runtime::Device> devices = runtime::find_devices();
    if (!options_.device.empty()) devices = {runtime::select_device(devices, options_.device)};
    for (const runtime::Device& device : devices) check_device(device, wanted);
    report();
    return failed_ == 0 ? exit_ok : exit_failure_found;
  }

 private:
  void check_device(const runtime::Device& device, std::optional<Variant> wanted) {
    const Variant variant = wanted.value_or(device.own_variant());
    if (!device.accepts_source && variant != device.own_variant()) {
      console_.notice(fmt::format("{}: takes no source, so not its {} variants; skipped",
                                  device.name, to_string(variant)));
      return;
    }
    const auto specs = chosen_kernels(options_, variant);
    if (device.accepts_source) {
      check_kernels(device, variant, specs, {});
    } else if (!options_.container.empty()) {
      check_kernels(device, variant, common(specs, tasks::vehicle_kernels()), options_.container);
    } else {
      check_by_task(device, variant, specs);
    }
  }

  /// An FPGA holds one container at a time, and few would hold the circuits of all tasks.
  void check_by_task(const runtime::Device& device, Variant variant,
                     const std::vector<const KernelSpec*>& specs) {
    for (const tasks::Task& task : tasks::all_tasks()) {
      const auto of_task = tasks::kernels_of(std::array{std::string(task.name)}, variant);
      const auto chosen = common(specs, of_task);
      if (chosen.empty()) continue;
      check_kernels(device, variant, chosen,
                    container_for(device, options_.machine, runtime::Execute::own, {}, of_task));
    }
  }

  void check_kernels(const runtime::Device& device, Variant variant,
                     const std::vector<const KernelSpec*>& specs, const std::string& container) {
    if (specs.empty()) return;
    runtime::SessionOptions session_options;
    session_options.variant = variant;
    session_options.container = container;
    const runtime::Session session(device, specs, session_options);
    ProgressBar bar(console_, device.name, specs.size());
    for (std::size_t done = 0; const KernelSpec* spec : specs) {
      add(device, variant, check(session, *spec, options_.full));
      bar.update(++done);
    }
    session.save_binaries();
  }

  void add(const runtime::Device& device, Variant variant, const Row& row) {
    const bool ok = row.failed == 0 && row.compared > 0;
    failed_ += ok ? 0 : 1;
    ++checked_;
    const std::string verdict =
        ok ? console_.paint(Colour::green, "pass")
           : console_.paint(Colour::red, "FAIL") +
                 fmt::format(" {}", row.first.empty() ? "nothing to compare" : row.first);
    table_.add({row.spec->task, row.spec->name, std::string(to_string(variant)), device.name,
                std::to_string(row.shapes), std::to_string(row.compared),
                fmt::format("{:g}", row.worst), verdict});
    Json item;
    item["task"] = row.spec->task;
    item["kernel"] = row.spec->name;
    item["variant"] = to_string(variant);
    item["device"] = device.name;
    item["shapes"] = row.shapes;
    item["compared"] = row.compared;
    item["worst_error"] = row.worst;
    item["pass"] = ok;
    if (!ok) item["first_difference"] = row.first;
    list_.push_back(std::move(item));
  }

  void report() {
    if (checked_ == 0) throw Error("verify: no kernel has such a variant on such a device");
    Json document;
    document["machine"] = options_.machine;
    document["checked"] = checked_;
    document["failed"] = failed_;
    document["kernels"] = std::move(list_);
    console_.result(fmt::format("{}{} of {} kernels equal their golden reference\n",
                                table_.to_string(console_.colour()), checked_ - failed_, checked_),
                    document);
  }

  const Options& options_;
  const Console& console_;
  Table table_{
      {"task", "kernel", "variant", "device", "shapes", "values", "worst error", "result"}};
  Json list_ = Json::array();
  std::size_t checked_ = 0, failed_ = 0;
};

}  // namespace

void add_verify(CLI::App& app, Context& context) {
  CLI::App* command = add_subcommand(
      app, context, "verify", "Check every kernel against its golden reference, on any device",
      "partita verify\npartita verify --machine native --full\n"
      "partita verify --machine native --variant gpu --kernel sobel");
  auto options = std::make_shared<Options>();
  add_machine_option(command, options->machine);
  command->add_option("-d,--device", options->device,
                      "Only this device: cpu, gpu, fpga or a part of its name");
  command
      ->add_option("--variant", options->variant,
                   "Text to check instead of the device's own, where it takes source")
      ->check(CLI::IsMember({"cpu", "gpu", "fpga"}));
  add_container_option(command, options->container);
  command->add_option("-k,--kernel", options->kernels, "Only these kernels, by commas")
      ->delimiter(',');
  command->add_flag("--full", options->full, "Also the large shapes, up to full pictures");
  command->callback([options, &context] {
    context.action = [options, &context] { return Verifier(*options, context.console).run(); };
  });
}

}  // namespace partita::app
