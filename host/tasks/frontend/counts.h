// What the cost of the front-end's frame depends on, beyond the pictures' size: known once it ran.
#ifndef PARTITA_HOST_TASKS_FRONTEND_COUNTS_H
#define PARTITA_HOST_TASKS_FRONTEND_COUNTS_H

#include <vector>

namespace partita::frontend {

/// One search for the reference frame's features, and the motion estimated from its matches.
struct SearchCounts {
  bool wide = false;   ///< which of the two windows
  int searched = 0;    ///< features of the reference with a predicted position
  int matches = 0;     ///< accepted, of those
  int hypotheses = 0;  ///< evaluated by RANSAC
  int inliers = 0;
  int iterations = 0;  ///< of the least squares
  bool operator==(const SearchCounts&) const = default;
};

struct FrameCounts {
  int keypoints_left = 0;
  int keypoints_right = 0;
  int reference = 0;  ///< features of the frame that it is matched with
  /// None on a first frame; two where the small window gave too few inliers.
  std::vector<SearchCounts> searches;
  bool operator==(const FrameCounts&) const = default;
};

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_COUNTS_H
