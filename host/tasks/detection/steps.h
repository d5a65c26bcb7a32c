// Work of detection's steps on the host processor.
#ifndef PARTITA_HOST_TASKS_DETECTION_STEPS_H
#define PARTITA_HOST_TASKS_DETECTION_STEPS_H

#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::detection {

/// Fitting a picture into the network's input. Shape: pixels (of the input).
const runtime::HostSpec& fit_spec();
/// Decoding and non-maximum suppression. Shape: anchors (boxes that the yolo layers have), classes,
/// candidates (boxes above the threshold), compared (pairs of boxes whose overlap was asked for).
const runtime::HostSpec& boxes_spec();

std::vector<const runtime::HostSpec*> host_specs();

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_STEPS_H
