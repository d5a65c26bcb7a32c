// The tracking task's kernels and host steps, for whoever runs, checks, packages or lists them.
// Sides of planes ("cells") are 16 or 32; see golden.h for the layouts.
#ifndef PARTITA_HOST_TASKS_TRACKING_KERNELS_H
#define PARTITA_HOST_TASKS_TRACKING_KERNELS_H

#include <vector>

#include "host/runtime/kernel_spec.h"

namespace partita::tracking {

/// All kernels of the task; Session wants them.
std::vector<const runtime::KernelSpec*> kernel_specs();
std::vector<const runtime::HostSpec*> host_specs();

/// Patches from windows of a picture. Shape: width, height, cells, patches, samples (bilinear ones,
/// all patches together).
const runtime::KernelSpec& resample_spec();
/// Gradient directions over cells. Shape: cells, patches.
const runtime::KernelSpec& cell_histograms_spec();
/// 31 channels of HOG, windowed. Shape: cells, patches.
const runtime::KernelSpec& cell_features_spec();
/// Fourier transforms of real planes. Shape: cells, planes.
const runtime::KernelSpec& spectra_spec();
/// Gaussian kernels between patches and models. Shape: cells, patches, scales.
const runtime::KernelSpec& correlate_spec();
/// Peaks of the filters' responses. Shape: cells, patches, scales.
const runtime::KernelSpec& respond_spec();
/// Coefficients and models, moved towards the newest. Shape: cells, targets.
const runtime::KernelSpec& train_spec();

/// The best scale of each target and the parabola through its peak. Shape: targets, patches.
const runtime::HostSpec& locate_spec();
/// Targets and detections put together. Shape: targets, detections.
const runtime::HostSpec& associate_spec();

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_KERNELS_H
