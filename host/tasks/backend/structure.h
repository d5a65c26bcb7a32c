// The sorted lists over which the device works: fixed for a problem, whatever its values.
#ifndef PARTITA_HOST_TASKS_BACKEND_STRUCTURE_H
#define PARTITA_HOST_TASKS_BACKEND_STRUCTURE_H

#include <array>
#include <cstdint>
#include <vector>

#include "host/tasks/backend/problem.h"

namespace partita::backend {

/// Slots are observations by camera, then by point, every camera's filled up to a multiple of 8.
struct Structure {
  int cameras = 0, points = 0, slots = 0;
  std::vector<int> slot_observation;  ///< -1: filled up
  std::vector<int> slot_point;
  std::vector<std::array<int, 4>> chunks;  ///< camera, first slot, slots (a multiple of 8), 0
  std::vector<int> camera_chunks;          ///< first chunk of a camera; one more at the end
  std::vector<int> point_start;            ///< first entry of a point in the next two; one more
  std::vector<int> point_slots;            ///< by camera
  std::vector<int> point_cameras;
  /// Cameras i <= j that see a point together, by i, then j; (i, i) always: first entry, its end,
  /// i, j. Those with a fixed camera are left out.
  std::vector<std::array<int, 4>> pairs;
  std::vector<std::array<int, 2>> entries;  ///< slot of i, slot of j: by point
};

/// Throws Error for an observation of a camera or point that is not there, and for a problem of
/// more entries than 32 bits count.
Structure make_structure(const Problem& problem);

}  // namespace partita::backend

#endif  // PARTITA_HOST_TASKS_BACKEND_STRUCTURE_H
