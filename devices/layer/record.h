// The record: besides what the timeline keeps, the wall time of every command as it ran here.
#ifndef PARTITA_DEVICES_LAYER_RECORD_H
#define PARTITA_DEVICES_LAYER_RECORD_H

#include <string>

#include "devices/layer/state.h"

namespace partita::layer {

/// Takes over one reference of the driver's event; its times are read once it is complete, in
/// batches and without waiting for it. Only while recording.
void measure(cl_event event, timeline::NodeId node);

/// Reads the times of all commands that are complete.
void harvest();

/// Harvests and writes the record to `path`, whole or not at all. CL_INVALID_OPERATION if nothing
/// is recorded, CL_OUT_OF_RESOURCES with a line on stderr if it cannot be written.
cl_int export_record(const std::string& path);

/// Writes the record to PARTITA_RECORD when the process exits.
void write_record_at_exit();

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_RECORD_H
