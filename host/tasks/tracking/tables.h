// Tables that the kernels take: computed once on the host, the same for every device.
#ifndef PARTITA_HOST_TASKS_TRACKING_TABLES_H
#define PARTITA_HOST_TASKS_TRACKING_TABLES_H

#include <vector>

namespace partita::tracking {

/// cos, then sin, of 2 pi j / cells for j < cells / 2.
std::vector<float> twiddle_table(int cells);
/// Hann's window at the cells' centres.
std::vector<float> taper_table(int cells);
/// The response that the filter is trained for: a Gaussian of `deviation` cells around (0, 0),
/// cyclically.
std::vector<float> label_plane(int cells, double deviation);

}  // namespace partita::tracking

#endif  // PARTITA_HOST_TASKS_TRACKING_TABLES_H
