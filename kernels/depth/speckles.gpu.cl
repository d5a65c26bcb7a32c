// Removes the segments that are too small, GPU variant.
// Assumes: labels and sizes as join_segments leaves them. One work-item a pixel, in groups of 64
// that lie along the rows, the NDRange rounded up.
#define GROUP 64

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void remove_speckles(
    __global ushort* restrict map, __global const int* restrict labels,
    __global const int* restrict sizes, int width, int height, int least) {
  const int i = (int)get_global_id(0);
  if (i >= width * height) return;
  const ushort d = map[i];
  const int root = labels[max(labels[i], 0)];
  const bool keep = sizes[max(root, 0)] >= least;
  map[i] = keep ? d : (ushort)0;
}
