#include "host/tasks/detection/evaluation.h"

#include <algorithm>
#include <numeric>

#include "host/runtime/error.h"

namespace partita::detection {

namespace {

constexpr std::size_t kMostDetections = 100;  // of a class in a picture
constexpr int kRecalls = 101;

double overlap_at(std::size_t index) {
  return 0.5 + 0.05 * static_cast<double>(index);
}

/// A detection that counts.
struct Hit {
  float score = 0;
  bool right = false;
};

/// One class in one picture.
struct Scene {
  std::vector<const Detection*> detections;  // by falling score
  std::vector<const TruthObject*> objects;   // those that count first
  std::vector<const Box*> regions;
  double least_height = 0;
};

Scene scene_of(const std::vector<Detection>& detections, const Truth& truth, int object_class) {
  Scene scene;
  scene.least_height = truth.least_height;
  for (const Detection& d : detections) {
    if (d.object_class == object_class) scene.detections.push_back(&d);
  }
  std::stable_sort(scene.detections.begin(), scene.detections.end(),
                   [](const Detection* a, const Detection* b) { return a->score > b->score; });
  if (scene.detections.size() > kMostDetections) scene.detections.resize(kMostDetections);
  for (const TruthObject& o : truth.objects) {
    if (o.object_class == object_class) scene.objects.push_back(&o);
  }
  std::stable_partition(scene.objects.begin(), scene.objects.end(),
                        [](const TruthObject* o) { return !o->ignored; });
  for (const IgnoredRegion& r : truth.regions) {
    if (r.object_class.value_or(object_class) == object_class) scene.regions.push_back(&r.box);
  }
  return scene;
}

/// The object that a detection takes, or objects.size().
std::size_t best_object(const Scene& scene, const std::vector<bool>& taken, const Box& box,
                        double threshold) {
  std::size_t best = scene.objects.size();
  double best_iou = std::min(threshold, 1.0 - 1e-10);
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (taken[i]) continue;
    // Those that count come first: none of the ignored ones is better than a match among them.
    if (scene.objects[i]->ignored && best < i && !scene.objects[best]->ignored) break;
    const double overlap = iou(box, scene.objects[i]->box);
    if (overlap < best_iou) continue;
    best_iou = overlap;
    best = i;
  }
  return best;
}

bool in_region(const Scene& scene, const Box& box, double threshold) {
  return std::any_of(scene.regions.begin(), scene.regions.end(), [&](const Box* region) {
    return box.area() > 0 && intersection(box, *region) >= threshold * box.area();
  });
}

void match(const Scene& scene, double threshold, std::vector<Hit>& hits) {
  std::vector<bool> taken(scene.objects.size());
  for (const Detection* d : scene.detections) {
    const std::size_t object = best_object(scene, taken, d->box, threshold);
    if (object < scene.objects.size()) {
      taken[object] = true;
      if (!scene.objects[object]->ignored) hits.push_back({d->score, true});
    } else if (d->box.height() >= scene.least_height && !in_region(scene, d->box, threshold)) {
      hits.push_back({d->score, false});
    }
  }
}

/// The mean of the best precision at recall 0, 0.01, ... 1 or above.
double average_precision(std::vector<Hit> hits, std::size_t objects) {
  std::stable_sort(hits.begin(), hits.end(),
                   [](const Hit& a, const Hit& b) { return a.score > b.score; });
  std::vector<double> precision(hits.size());
  std::vector<double> recall(hits.size());
  double right = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    right += hits[i].right ? 1 : 0;
    precision[i] = right / static_cast<double>(i + 1);
    recall[i] = right / static_cast<double>(objects);
  }
  for (std::size_t i = hits.size(); i-- > 1;) {
    precision[i - 1] = std::max(precision[i - 1], precision[i]);
  }
  double sum = 0;
  for (int k = 0; k < kRecalls; ++k) {
    const auto at = std::lower_bound(recall.begin(), recall.end(), 0.01 * k) - recall.begin();
    if (at < static_cast<std::ptrdiff_t>(hits.size()))
      sum += precision[static_cast<std::size_t>(at)];
  }
  return sum / kRecalls;
}

ClassPrecision precision_of(const std::vector<Scene>& scenes) {
  ClassPrecision result;
  for (const Scene& scene : scenes) {
    for (const TruthObject* o : scene.objects) result.objects += o->ignored ? 0 : 1;
  }
  if (result.objects == 0) return result;
  for (std::size_t t = 0; t < kOverlaps; ++t) {
    std::vector<Hit> hits;
    for (const Scene& scene : scenes) match(scene, overlap_at(t), hits);
    const auto right =
        std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return hit.right; });
    if (t == 0) result.recall50 = static_cast<double>(right) / static_cast<double>(result.objects);
    result.ap[t] = average_precision(std::move(hits), result.objects);
  }
  return result;
}

}  // namespace

double ClassPrecision::ap50_95() const {
  return std::accumulate(ap.begin(), ap.end(), 0.0) / static_cast<double>(kOverlaps);
}

Precision evaluate(const std::vector<std::vector<Detection>>& detections,
                   const std::vector<Truth>& truths, int classes) {
  if (detections.size() != truths.size()) throw Error("evaluation: not one truth for each picture");
  Precision result;
  for (int c = 0; c < classes; ++c) {
    std::vector<Scene> scenes;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      scenes.push_back(scene_of(detections[i], truths[i], c));
    }
    result.classes.push_back(precision_of(scenes));
    const ClassPrecision& own = result.classes.back();
    if (own.objects == 0) continue;
    ++result.classes_with_objects;
    result.ap50 += own.ap50();
    result.ap75 += own.ap[5];
    result.ap50_95 += own.ap50_95();
  }
  if (result.classes_with_objects == 0) return result;
  const auto count = static_cast<double>(result.classes_with_objects);
  result.ap50 /= count;
  result.ap75 /= count;
  result.ap50_95 /= count;
  return result;
}

}  // namespace partita::detection
