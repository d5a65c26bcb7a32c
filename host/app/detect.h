// The parts of `partita detect`: what is to be found, how well it was, and how that is told.
#ifndef PARTITA_HOST_APP_DETECT_H
#define PARTITA_HOST_APP_DETECT_H

#include <string>
#include <vector>

#include "host/app/console.h"
#include "host/tasks/detection/evaluation.h"
#include "host/tasks/sensing/frame.h"

namespace partita::app {

/// A picture and what was found in it.
struct DetectedPicture {
  std::string path;  ///< as on the command line
  int width = 0, height = 0;
  std::vector<detection::Detection> detections;
};

/// Which of KITTI's objects count: by height, occlusion and truncation, as its benchmark has it.
enum class Difficulty { easy, moderate, hard, all };

/// The truth of each picture in the classes of `names`. `path`: COCO's annotations (.json), where
/// pictures are found by file name, or a folder with KITTI's labels, or one that holds label_2/,
/// where NAME.png belongs to NAME.txt. A class of the truth that is not among `names` cannot be
/// found and does not count. Throws Error for a picture without truth.
std::vector<detection::Truth> read_truth(const std::string& path,
                                         const std::vector<std::string>& pictures,
                                         const std::vector<std::string>& names,
                                         Difficulty difficulty);

/// COCO's results: a list of image_id, category_id, bbox and score; file_name and category_name
/// beside them. Image ids count from 0. Category ids are COCO's where all names are COCO's, else
/// the classes' positions from 0.
Json coco_results(const std::vector<DetectedPicture>& pictures,
                  const std::vector<std::string>& names);

Json precision_json(const detection::Precision& precision, const std::vector<std::string>& names);
Table precision_table(const detection::Precision& precision, const std::vector<std::string>& names);

/// Draws boxes, names and scores into the picture.
void draw_detections(sensing::ColourImage& picture,
                     const std::vector<detection::Detection>& detections,
                     const std::vector<std::string>& names);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_DETECT_H
