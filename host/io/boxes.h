// Boxes of tracked objects as text: one object's, a line per picture, as the tracking benchmarks
// have them (OTB, UAV123); many objects' in the format of the MOT challenge.
#ifndef PARTITA_HOST_IO_BOXES_H
#define PARTITA_HOST_IO_BOXES_H

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/tasks/tracking/box.h"

namespace partita::io {

/// Reads "x,y,w,h" lines, separated by commas, blanks or tabs. Four times "nan" is a picture in
/// which the object is not to be seen. Throws Error with file and line for anything else, for a
/// negative size, and for a file without boxes.
std::vector<std::optional<tracking::Box>> read_boxes(const std::string& path);

/// Writes them with two decimals, "nan,nan,nan,nan" for none.
void write_boxes(const std::string& path, const std::vector<std::optional<tracking::Box>>& boxes);

/// An object in a frame.
struct MotRow {
  std::size_t frame = 0;  ///< from 0; the file counts from 1
  int id = 0;
  tracking::Box box;
  double confidence = 1;
};

/// Writes "frame,id,x,y,w,h,confidence,-1,-1,-1" lines in the order given.
void write_mot(const std::string& path, const std::vector<MotRow>& rows);

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_BOXES_H
