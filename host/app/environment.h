// Where Partita's own files lie, and the environment variables that bring the emulation layer in.
#ifndef PARTITA_HOST_APP_ENVIRONMENT_H
#define PARTITA_HOST_APP_ENVIRONMENT_H

#include <string>

namespace partita::app {

/// Found relative to the executable: <build>/bin + <build>/lib + <build>/share in a build tree,
/// <prefix>/bin + <prefix>/lib/partita + <prefix>/share when installed. Empty: not found.
struct Places {
  std::string layer;       ///< libpartita_layer.so
  std::string profiles;    ///< folder with devices/ and machines/; PARTITA_PROFILES wins
  std::string containers;  ///< folder with the FPGA containers that the build packaged
};
const Places& places();

struct EmulationOptions {
  std::string machine = "dragonfly";  ///< name or file; "native": no layer at all
  bool allow_source = false;          ///< lift the FPGA's no-source rule
  std::string fault = {};             ///< fault injection, see docs/emulation.md; empty: none
  bool recording = false;             ///< keep the graph for Extension::export_record
  std::string record = {};            ///< file for the record at process exit; empty: none
};

inline constexpr const char* kNativeMachine = "native";

/// Sets OPENCL_LAYERS and PARTITA_* for this process and its children. Must run before the first
/// OpenCL call. Checks the machine first: throws Error with the file, line and key at fault.
/// For "native" it removes the layer from the environment instead.
void set_emulation(const EmulationOptions& options);

/// The machine's file: `machine` itself if it is a path, else <profiles>/machines/<machine>.yaml.
std::string machine_file(const std::string& machine);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_ENVIRONMENT_H
