// From boxes to the windows that resample takes, and from peaks back to boxes.
#ifndef PARTITA_HOST_TASKS_TRACKING_WINDOWS_H
#define PARTITA_HOST_TASKS_TRACKING_WINDOWS_H

#include <array>
#include <cstdint>
#include <span>

#include "host/tasks/tracking/box.h"
#include "host/tasks/tracking/filters.h"
#include "host/tasks/tracking/golden.h"

namespace partita::tracking {

using Window = std::array<std::int32_t, kWindowEntries>;

/// The size of the s-th scale over the box's; the middle one is 1.
double scale_factor(const FilterParameters& parameters, int s);

/// Side of the square window around a box at scale `factor`, px.
double window_side(const FilterParameters& parameters, const Box& box, double factor);

/// The window around a box's centre in 16.16, with as many taps as the reduction asks for.
Window make_window(const FilterParameters& parameters, const Box& box, double factor);

/// The box after its target has been found: of the scales' peaks the best one, refined by
/// parabolas. `peaks`: kPeakEntries per scale.
Located interpret_peaks(const FilterParameters& parameters, const Box& box,
                        std::span<const float> peaks, Picture size);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_WINDOWS_H
