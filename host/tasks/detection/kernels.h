// The detection task's kernels, for whoever runs, checks, packages or lists them.
#ifndef PARTITA_HOST_TASKS_DETECTION_KERNELS_H
#define PARTITA_HOST_TASKS_DETECTION_KERNELS_H

#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::detection {

/// All kernels of the task; Session wants them.
std::vector<const runtime::KernelSpec*> kernel_specs();

// Shapes have width, height and channels (`outputs`) of the result, its `border`, and:

/// Convolution, bias, activation, residual. inputs, outputs, size, stride, lanes, residual (0, 1),
/// activation (io::darknet::Activation).
const runtime::KernelSpec& convolution_spec();
/// A window for each channel. channels, size, stride, residual, activation.
const runtime::KernelSpec& depthwise_spec();
/// Largest number of each window. channels, size, stride, before, in_width, in_height.
const runtime::KernelSpec& maxpool_spec();
/// Pixels repeated; copies with stride 1. channels, stride.
const runtime::KernelSpec& upsample_spec();
/// Activation of the sum of two maps. channels, activation.
const runtime::KernelSpec& add_spec();

/// Outputs whose weights lie next to each other: 8, 16 or 32, as fits `outputs` best.
int lanes_for(int outputs);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_KERNELS_H
