// Limits of what runs underneath.
#ifndef PARTITA_DEVICES_LAYER_DRIVER_LIMITS_H
#define PARTITA_DEVICES_LAYER_DRIVER_LIMITS_H

#include "devices/layer/state.h"

namespace partita::layer {

/// Lowers what the profiles promise to what the driver's device can execute (work-group sizes,
/// image sizes, argument bytes, allocation sizes): a program that trusts the query must not fail.
void clamp_to_driver(State& state);

}  // namespace partita::layer

#endif  // PARTITA_DEVICES_LAYER_DRIVER_LIMITS_H
