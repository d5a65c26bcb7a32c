// Packager: the FPGA container of a set of tasks, from their kernel specs and the embedded text.
#ifndef PARTITA_HOST_APP_PACKAGER_H
#define PARTITA_HOST_APP_PACKAGER_H

#include <string>
#include <vector>

#include "devices/layer/container.h"
#include "devices/profile/profile.h"
#include "host/runtime/session.h"

namespace partita::app {

struct PackageOptions {
  std::vector<std::string> tasks;  ///< empty: those of the vehicle's container
  /// These instead of the tasks'.
  std::vector<const runtime::KernelSpec*> kernels = {};
  runtime::Execute model = runtime::Execute::own;
};

/// All FPGA kernels of the tasks as one container. With Model "own" the .fpga.cl text is the
/// functional model, with "fast" the .cpu.cl text; circuits, area and clock are those of the FPGA
/// variant either way. Does not ask whether the design fits. Throws Error if a task is unknown or
/// has no FPGA kernel, profile::Error if the profile is no FPGA's.
layer::Container make_container(const profile::DeviceProfile& device,
                                const PackageOptions& options);

/// "zcu102.fast.fpgabin"
std::string container_name(const std::string& profile, runtime::Execute model);

/// The container for an emulated device: the build's, or, for a profile that the build did not know
/// or that has changed since, one that is packaged now and kept in the user's cache folder.
/// Holds the vehicle's kernels, or those that are named.
std::string container_for(const profile::DeviceProfile& device, runtime::Execute model,
                          const std::vector<const runtime::KernelSpec*>& kernels = {});

/// `given`, if the user named one; else the same by an emulated device that takes no source and the
/// machine that it belongs to. For a real device without one it throws Error: its container comes
/// from the vendor's tools.
std::string container_for(const runtime::Device& device, const std::string& machine,
                          runtime::Execute model, const std::string& given,
                          const std::vector<const runtime::KernelSpec*>& kernels = {});

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_PACKAGER_H
