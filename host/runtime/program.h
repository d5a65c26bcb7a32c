// Programs from whatever a device accepts: source, a binary that an earlier run cached, or a
// container (on a Xilinx card an xclbin).
#ifndef PARTITA_HOST_RUNTIME_PROGRAM_H
#define PARTITA_HOST_RUNTIME_PROGRAM_H

#include <optional>
#include <string>

#include "host/runtime/device.h"

namespace partita::runtime {

/// $XDG_CACHE_HOME/partita, or ~/.cache/partita; created if need be. Empty if neither can be had:
/// then nothing is cached.
std::string user_cache_folder();

/// File below `folder` for a program: named by a hash of device, driver, options and text, so that
/// a change of any of them is another file.
std::string cache_path(const std::string& folder, const Device& device, const std::string& options,
                       const std::string& text);

/// Compiles `text`; `name` (the kernel file) appears in the Error with the first compiler message.
cl::Program build_from_source(const cl::Context& context, const Device& device,
                              const std::string& name, const std::string& text,
                              const std::string& options);

/// A program from a cached binary; empty if the file is missing or the driver refuses it (after an
/// update, say): then build from source.
std::optional<cl::Program> build_from_cache(const cl::Context& context, const Device& device,
                                            const std::string& path, const std::string& options);

/// Writes the program's binary to `path`, whole or not at all; a cache that cannot be written is
/// no error.
void save_binary(const cl::Program& program, const std::string& path);

/// A program from a container file. Throws Error if it cannot be read or the device refuses it.
cl::Program build_from_container(const cl::Context& context, const Device& device,
                                 const std::string& path);

}  // namespace partita::runtime

#endif  // PARTITA_HOST_RUNTIME_PROGRAM_H
