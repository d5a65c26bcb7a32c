// How good detections are: average precision, as COCO computes it.
#ifndef PARTITA_HOST_TASKS_DETECTION_EVALUATION_H
#define PARTITA_HOST_TASKS_DETECTION_EVALUATION_H

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/tasks/detection/decode.h"

namespace partita::detection {

/// What is to be found in a picture.
struct TruthObject {
  Box box;
  int object_class = 0;
  bool ignored = false;  ///< to find it or not is neither right nor wrong (KITTI: too difficult)
};

/// An area in which what is found is neither right nor wrong: KITTI's DontCare, COCO's crowds.
struct IgnoredRegion {
  Box box;
  std::optional<int> object_class = {};  ///< of this class only
};

struct Truth {
  std::vector<TruthObject> objects;
  std::vector<IgnoredRegion> regions;
  double least_height = 0;  ///< lower detections that match nothing do not count
};

inline constexpr std::size_t kOverlaps = 10;  ///< IoU 0.50, 0.55, ... 0.95

struct ClassPrecision {
  std::size_t objects = 0;  ///< that count; without any, the class has no precision
  std::array<double, kOverlaps> ap{};
  double recall50 = 0;  ///< share of the objects found at IoU 0.50, at any score
  double ap50() const { return ap[0]; }
  double ap50_95() const;
};

struct Precision {
  std::vector<ClassPrecision> classes;
  // Means over the classes that have objects.
  double ap50 = 0;
  double ap75 = 0;
  double ap50_95 = 0;
  std::size_t classes_with_objects = 0;
};

/// `detections[i]` belong to `truths[i]`. For each class and IoU threshold: in each picture the 100
/// detections of highest score, by falling score, each take the object of largest IoU, of those not
/// taken yet and at or above the threshold; an ignored object only where no other is left. One that
/// takes none is ignored if a region covers that share of it, or if it is lower than least_height;
/// else it is wrong. All pictures' detections sorted by score give precision over recall; AP is the
/// mean, over recalls 0.00, 0.01, ... 1.00, of the best precision at that recall or above.
Precision evaluate(const std::vector<std::vector<Detection>>& detections,
                   const std::vector<Truth>& truths, int classes);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_EVALUATION_H
