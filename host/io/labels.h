// What data sets say about the objects in their pictures, and names of classes.
#ifndef PARTITA_HOST_IO_LABELS_H
#define PARTITA_HOST_IO_LABELS_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace partita::io {

/// Edges in pixels.
struct LabelBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// One line of a file of KITTI's label_2; of its 3D box only what a 2D evaluation asks for.
struct KittiLabel {
  std::string type;  ///< Car, Van, Truck, Pedestrian, Person_sitting, Cyclist, Tram, Misc, DontCare
  double truncated = 0;  ///< share outside of the picture, 0..1; -1 unknown
  int occluded = 0;      ///< 0 fully visible, 1 partly, 2 largely hidden, 3 unknown; -1 DontCare
  LabelBox box;
};

/// An empty file is a picture without objects. Throws Error with file and line for what is not a
/// label: 15 fields, or 16 with a score.
std::vector<KittiLabel> read_kitti_labels(const std::string& path);

/// COCO's "instances" annotations.
struct CocoObject {
  std::size_t image = 0;     ///< in images
  std::size_t category = 0;  ///< in categories
  LabelBox box;
  bool crowd = false;
};
struct CocoImage {
  std::int64_t id = 0;
  std::string file_name;
};
struct CocoCategory {
  std::int64_t id = 0;
  std::string name;
};
struct CocoTruth {
  std::vector<CocoImage> images;
  std::vector<CocoCategory> categories;
  std::vector<CocoObject> objects;
};

/// Throws Error with the file and the annotation for what is missing or of another type.
CocoTruth read_coco_truth(const std::string& path);

/// One name for each line, as in Darknet's .names files. Throws Error for a file without names.
std::vector<std::string> read_names(const std::string& path);

/// The id that COCO's annotations give to one of its 80 classes.
std::optional<int> coco_category(const std::string& name);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_LABELS_H
