#include "host/app/environment.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <system_error>

#include <fmt/format.h>

#include "devices/profile/machine.h"
#include "host/runtime/error.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLayerName = "libpartita_layer.so";

std::string first_existing(std::initializer_list<fs::path> candidates) {
  for (const fs::path& path : candidates) {
    std::error_code code;
    if (!path.empty() && fs::exists(path, code)) return fs::weakly_canonical(path).string();
  }
  return {};
}

Places find_places() {
  std::error_code code;
  const fs::path bin = fs::read_symlink("/proc/self/exe", code).parent_path();
  const fs::path prefix = bin.parent_path();
  const char* profiles = std::getenv("PARTITA_PROFILES");
  Places found;
  found.layer =
      first_existing({prefix / "lib" / kLayerName, prefix / "lib" / "partita" / kLayerName});
  found.profiles =
      profiles != nullptr && *profiles != '\0'
          ? std::string(profiles)
          : first_existing({prefix / "share/partita/profiles", PARTITA_SOURCE_PROFILES});
  found.containers = first_existing({prefix / "share/partita/containers"});
  return found;
}

/// The list OPENCL_LAYERS without our layer: others (a tracer, say) stay where they are.
std::string other_layers() {
  const char* value = std::getenv("OPENCL_LAYERS");
  std::string kept;
  for (std::string_view rest = value == nullptr ? "" : value; !rest.empty();) {
    const std::string_view item = rest.substr(0, rest.find(':'));
    if (!item.empty() && fs::path(item).filename() != kLayerName) {
      if (!kept.empty()) kept += ':';
      kept += item;
    }
    rest.remove_prefix(std::min(rest.size(), item.size() + 1));
  }
  return kept;
}

void set_or_unset(const char* name, const std::string& value) {
  if (value.empty()) {
    unsetenv(name);
  } else {
    setenv(name, value.c_str(), 1);
  }
}

}  // namespace

const Places& places() {
  static const Places found = find_places();
  return found;
}

std::string machine_file(const std::string& machine) {
  return fs::absolute(profile::load_machine(machine, places().profiles).path).string();
}

void set_emulation(const EmulationOptions& options) {
  const std::string others = other_layers();
  if (options.machine == kNativeMachine) {
    set_or_unset("OPENCL_LAYERS", others);
    unsetenv("PARTITA_MACHINE");
    return;
  }
  const std::string file = machine_file(options.machine);
  if (places().layer.empty()) {
    throw Error(
        fmt::format("{}: the emulation layer was not found beside this program; use "
                    "--machine native to run without it",
                    kLayerName));
  }
  set_or_unset("OPENCL_LAYERS", others.empty() ? places().layer : places().layer + ":" + others);
  // ocl-icd would start PoCL, to sort the platforms, before the layer has asked it for one worker
  // thread for each emulated device.
  setenv("OCL_ICD_PLATFORM_SORT", "none", 1);
  set_or_unset("PARTITA_MACHINE", file);
  set_or_unset("PARTITA_PROFILES", places().profiles);
  set_or_unset("PARTITA_ALLOW_SOURCE", options.allow_source ? "1" : "");
  set_or_unset("PARTITA_FAULT", options.fault);
  set_or_unset("PARTITA_RECORDING", options.recording ? "1" : "");
  set_or_unset("PARTITA_RECORD", options.record);
}

}  // namespace partita::app
