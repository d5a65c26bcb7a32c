// What a launch costs on the host: the measurement behind `partita bench overhead`.
#ifndef PARTITA_HOST_APP_OVERHEAD_H
#define PARTITA_HOST_APP_OVERHEAD_H

#include <cstddef>
#include <string>
#include <vector>

#include "host/runtime/device.h"

namespace partita::app {

/// A batch is `commands` launches of a kernel that does next to nothing, on one in-order profiling
/// queue, and a clFinish at its end.
struct Batches {
  std::size_t commands = 2000;
  std::size_t batches = 15;
};

/// Nanoseconds per command of one batch: what the calls took on the host thread, and all of it
/// until the clFinish returned (which the device's worker may bound instead).
struct Batch {
  double calls = 0;
  double all = 0;
};

/// clSetKernelArg and clEnqueueNDRangeKernel, with nothing of ours around them; where the layer is,
/// each launch declares its Work, as ours do.
std::vector<Batch> raw_launches(const runtime::Device& device, const Batches& size);

/// The same launches, in turns through OpenCL directly and through runtime::Kernel::launch.
struct Pair {
  std::vector<Batch> raw, framework;
};
Pair raw_and_framework_launches(const runtime::Device& device, const Batches& size);

struct Quartiles {
  double low = 0, median = 0, high = 0;
  double range() const { return high - low; }
};

/// Of one figure of the batches, by nearest rank. Not of nothing.
Quartiles quartiles(const std::vector<Batch>& batches, double Batch::*figure);

/// Whether two medians are no further apart than either side's own interquartile range.
bool below_noise(const Quartiles& a, const Quartiles& b);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_OVERHEAD_H
