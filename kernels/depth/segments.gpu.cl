// Segments of similar disparities: pixels are of one segment if a chain of neighbours (left, right,
// above, below) joins them that all have disparities and differ by at most `similarity`, 1/256 px.
// segments: inside each band of BAND rows; labels: the least index of a pixel of the segment, -1
// where there is no disparity; sizes: pixels of the segment at its least index, 0 elsewhere.
// join_segments: across the bands; the segments that touch a border between bands get their least
// index of all bands as the label of their first pixels and of their pixels at the borders, and
// their whole size there. So a pixel's segment is the label of its label. GPU variant.
// Assumes: pictures with fewer than 2^31 pixels. segments: a group of 64 work-items takes a band;
// join_segments: a single group takes all borders. Labels only ever sink, by atomic minimum, so
// that the result does not depend on the order.
#include "depth/constants.clh"

#define GROUP 64
#define JOINERS 256

static inline bool alike(int a, int b, int similarity) {
  return a != 0 && b != 0 && max(a, b) - min(a, b) <= similarity;
}

static inline int root_of(volatile __global int* labels, int i) {
  for (int next = atomic_or(labels + i, 0); next != i; next = atomic_or(labels + i, 0)) i = next;
  return i;
}

static inline void unite(volatile __global int* labels, int a, int b) {
  a = root_of(labels, a);
  b = root_of(labels, b);
  while (a != b) {
    const int high = max(a, b);
    const int low = min(a, b);
    const int before = atomic_min(labels + high, low);
    // Somebody else was there first: what `high` belonged to is to be united with `low`.
    a = before == high ? low : root_of(labels, before);
    b = root_of(labels, low);
  }
}

static inline void move_size(volatile __global int* sizes, int from, int to) {
  const int size = from != to ? atomic_xchg(sizes + from, 0) : 0;
  if (size > 0) atomic_add(sizes + to, size);
}

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void segments(
    __global const ushort* restrict map, __global int* labels, __global int* sizes, int width,
    int height, int similarity) {
  const int lane = (int)get_local_id(0);
  const int top = (int)get_group_id(0) * BAND;
  const int begin = top * width + lane;
  const int end = min(top + BAND, height) * width;
  for (int i = begin; i < end; i += GROUP) {
    labels[i] = map[i] != 0 ? i : -1;
    sizes[i] = 0;
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int i = begin; i < end; i += GROUP) {
    const int d = map[i];
    const int left = i % width > 0 ? map[i - 1] : 0;
    const int above = i >= (top + 1) * width ? map[i - width] : 0;
    if (alike(d, left, similarity)) unite(labels, i, i - 1);
    if (alike(d, above, similarity)) unite(labels, i, i - width);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int i = begin; i < end; i += GROUP) {
    if (map[i] == 0) continue;
    const int root = root_of(labels, i);
    atomic_min(labels + i, root);
    atomic_add(sizes + root, 1);
  }
}

__kernel __attribute__((reqd_work_group_size(JOINERS, 1, 1))) void join_segments(
    __global const ushort* restrict map, __global int* labels, __global int* sizes, int width,
    int height, int similarity) {
  const int lane = (int)get_local_id(0);
  for (int y = BAND; y < height; y += BAND) {
    for (int x = lane; x < width; x += JOINERS) {
      const int i = y * width + x;
      if (alike(map[i], map[i - width], similarity)) unite(labels, i, i - width);
    }
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int y = BAND; y < height; y += BAND) {
    for (int i = (y - 1) * width + lane; i < (y + 1) * width; i += JOINERS) {
      const int band = atomic_or(labels + i, 0);
      if (band < 0) continue;
      const int root = root_of(labels, band);
      atomic_min(labels + i, root);
      atomic_min(labels + band, root);
      move_size(sizes, i, root);  // it may be its part's first pixel itself
      move_size(sizes, band, root);
    }
  }
}
