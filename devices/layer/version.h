// Version numbers and word lists as OpenCL's queries give them.
#ifndef PARTITA_DEVICES_LAYER_VERSION_H
#define PARTITA_DEVICES_LAYER_VERSION_H

#include <string>
#include <string_view>
#include <vector>

#include <CL/cl.h>

namespace partita::layer {

/// "OpenCL 3.0 CUDA" with prefix "OpenCL " gives 3.0.0; what does not parse gives 1.0.0.
cl_version parse_version(std::string_view text, std::string_view prefix);

std::vector<std::string> split_words(std::string_view text);

/// A name with its version, as the *_WITH_VERSION queries list it.
cl_name_version name_version(std::string_view name, cl_version version);

/// Extensions with version 1.0.0 each: Khronos' own have had no other revision at the time of the
/// emulated runtimes.
std::vector<cl_name_version> with_versions(const std::vector<std::string>& extensions);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_VERSION_H
