// What the compiler underneath must be told so that it compiles as the emulated device would.
#ifndef PARTITA_DEVICES_LAYER_PROGRAM_TEXT_H
#define PARTITA_DEVICES_LAYER_PROGRAM_TEXT_H

#include <string>
#include <vector>

#include "devices/layer/state.h"

namespace partita::layer {

/// Lines that go before a program's source: they take away the macros of extensions and features
/// that a device of the context does not have, set __OPENCL_VERSION__, and turn `double` into an
/// error where there are none. Ends with "#line 1", so that messages keep their line numbers.
std::string prelude(const std::vector<Device*>& devices);

struct BuildOptions {
  std::string text;     ///< for the driver
  std::string refusal;  ///< not empty: the build fails with this log
  bool keeps_arg_info = false;
};

/// The program's options for clBuildProgram and clCompileProgram, completed: OpenCL C 1.2 unless
/// the program asks for more, and then only if all devices compile it.
BuildOptions build_options(const char* options, const std::vector<Device*>& devices);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_PROGRAM_TEXT_H
