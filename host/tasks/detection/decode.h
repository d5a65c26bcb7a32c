// From the numbers of yolo layers to boxes in the picture.
#ifndef PARTITA_HOST_TASKS_DETECTION_DECODE_H
#define PARTITA_HOST_TASKS_DETECTION_DECODE_H

#include <vector>

#include "host/tasks/detection/darknet_network.h"
#include "host/tasks/detection/letterbox.h"

namespace partita::detection {

/// Edges in pixels of the picture, x to the right and y down from the top left corner; pixel (0, 0)
/// is [0, 1) x [0, 1).
struct Box {
  double left = 0, top = 0, right = 0, bottom = 0;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
  double area() const { return width() * height(); }
};

/// Common area of two boxes.
double intersection(const Box& a, const Box& b);
/// Common area over that of both together; 0 where both are empty.
double iou(const Box& a, const Box& b);
Box clipped(const Box& box, int picture_width, int picture_height);

struct Detection {
  Box box;  ///< as the network has it: it may reach out of the picture
  int object_class = 0;
  float score = 0;  ///< objectness times the class's probability
};

/// All boxes whose best class has a score above the threshold, in the order of the layers, rows,
/// columns and anchors. A box has the class with the highest score, the first one of equals. With
/// l the logistic function, a = scale_x_y, and the anchor's width w_a, in pixels of the input:
///   x = (column + a * l(t_x) - (a - 1) / 2) * input width / columns,   w = w_a * exp(t_w),
/// likewise y and h; score = l(t_o) * l(t_class). Numbers that are not finite give no box.
std::vector<Detection> decode(const io::darknet::Model& model,
                              const std::vector<RawOutput>& outputs, const Placed& placed,
                              float threshold);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_DECODE_H
