// Fits a picture into a network's input.
#ifndef PARTITA_HOST_TASKS_DETECTION_LETTERBOX_H
#define PARTITA_HOST_TASKS_DETECTION_LETTERBOX_H

#include <vector>

#include "host/tasks/sensing/frame.h"

namespace partita::detection {

/// letterbox: the picture keeps its shape and gray bars fill the rest, as Darknet does it;
/// stretch: it fills the input, as OpenCV's blobFromImage does it.
enum class Fit { letterbox, stretch };

/// Where a picture lies in the network's input: `width` x `height` pixels from `left`, `top`.
struct Placed {
  int input_width = 0, input_height = 0;
  int picture_width = 0, picture_height = 0;
  int left = 0, top = 0;
  int width = 0, height = 0;
};
Placed place(int picture_width, int picture_height, int input_width, int input_height, Fit fit);

/// The network's input: [y][x][red, green, blue], 0 to 1, bars 0.5. Resized by linear interpolation
/// between pixel centres with weights of 1/2048, to whole gray levels: those of OpenCV's
/// INTER_LINEAR for 8-bit pictures, but for one level at one pixel in a few hundred. Reuses `out`'s
/// memory.
void fit_picture(const sensing::ColourImage& picture, const Placed& placed,
                 std::vector<float>& out);

}  // namespace partita::detection

#endif  // PARTITA_HOST_TASKS_DETECTION_LETTERBOX_H
