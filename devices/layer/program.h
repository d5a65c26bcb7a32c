// What the files about programs share.
#ifndef PARTITA_DEVICES_LAYER_PROGRAM_H
#define PARTITA_DEVICES_LAYER_PROGRAM_H

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "devices/layer/state.h"

namespace partita::layer {

std::shared_ptr<Program> find_program(cl_program handle);
std::shared_ptr<Context> known_context(cl_context handle);

/// An entry for a program of all the context's devices, not yet in the registry.
std::shared_ptr<Program> make_program(std::shared_ptr<Context> context);
void register_program(cl_program handle, std::shared_ptr<Program> program);

/// Whether `list` names devices of `devices` only; none at all is all of them.
cl_int check_device_list(const std::vector<Device*>& devices, cl_uint count,
                         const cl_device_id* list);

/// clCreateProgramWithSource of the driver, behind the prelude.
cl_program create_driver_program(cl_context context, const std::vector<Device*>& devices,
                                 const std::string& source, cl_int& error);

/// The driver's binary, one for all devices; empty if there is none yet. Of a built program PoCL
/// compiles all kernels to machine code first, of one that is only compiled, or of a library, none.
std::string driver_binary(cl_program handle);

/// The same of a program that `make` makes for this alone; null gives an empty one. One at a time:
/// PoCL keeps programs of the same code in one folder, which it removes with the first of them.
std::string twin_binary(const std::function<cl_program()>& make);

/// An FPGA takes a container: checks it, charges the loading to the predicted clock and compiles
/// its functional model. Null with `error` set if it refuses.
cl_program load_container(cl_context context, std::shared_ptr<Context> entry,
                          std::span<const std::byte> bytes, cl_int& error);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_PROGRAM_H
