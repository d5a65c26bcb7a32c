// Segments of similar disparities; see segments.gpu.cl for what they are. CPU variant.
// Assumes: pictures with fewer than 2^31 pixels. segments: one work-item takes a band of BAND rows;
// join_segments: one takes everything, for there are few borders. Local size 1.
#include "depth/segments.clh"

// First every pixel gets the root of its run, and roots of runs above each other are united under
// the least, once where they meet; then, as roots come before what they hold, one pass in order
// replaces every label by its root's.
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void segments(
    __global const ushort* restrict map, __global int* restrict labels,
    __global int* restrict sizes, int width, int height, int similarity) {
  const int top = (int)get_global_id(0) * BAND;
  const int bottom = min(top + BAND, height);
  for (int y = top; y < bottom; ++y) {
    int root = -1;
    int left = 0;
    int over_left = 0;  // above it, if it is alike
    for (int i = y * width; i < (y + 1) * width; ++i) {
      const int d = map[i];
      const bool goes_on = alike(d, left, similarity);
      if (!goes_on) root = d != 0 ? i : -1;
      left = d;
      labels[i] = root;
      const int over = y > top ? map[i - width] : 0;
      const bool joined = alike(d, over, similarity);
      const bool known = goes_on && alike(over, over_left, similarity);
      over_left = joined ? over : 0;
      if (!joined || known) continue;
      const int above = root_of(labels, labels[i - width]);
      const int least = min(above, root);
      labels[above] = least;
      labels[root] = least;
      root = least;
    }
  }
  for (int i = top * width; i < bottom * width; ++i) {
    sizes[i] = 0;
    if (labels[i] < 0) continue;
    const int root = labels[labels[i]];
    labels[i] = root;
    sizes[root] += 1;
  }
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void join_segments(
    __global const ushort* restrict map, __global int* restrict labels,
    __global int* restrict sizes, int width, int height, int similarity) {
  join_all(map, labels, sizes, width, height, similarity);
}
