// What a launch costs on the host: the measurement behind `partita bench overhead`.
#ifndef PARTITA_HOST_APP_OVERHEAD_H
#define PARTITA_HOST_APP_OVERHEAD_H

#include <cstddef>
#include <string>
#include <vector>

#include "host/runtime/device.h"

namespace partita::app {

/// Nanoseconds per command, one value per batch. A batch is `commands` launches of a kernel that
/// does next to nothing, on one in-order profiling queue, with a clFinish at its end, which is
/// included.
struct Batches {
  std::size_t commands = 2000;
  std::size_t batches = 15;
};

/// clSetKernelArg and clEnqueueNDRangeKernel, with nothing of ours around them; where the layer is,
/// each launch declares its Work, as ours do.
std::vector<double> raw_launches(const runtime::Device& device, const Batches& size);

/// The same launches, in turns through OpenCL directly and through runtime::Kernel::launch.
struct Pair {
  std::vector<double> raw, framework;
};
Pair raw_and_framework_launches(const runtime::Device& device, const Batches& size);

double median(std::vector<double> values);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_OVERHEAD_H
