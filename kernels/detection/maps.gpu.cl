// maxpool, upsample_map and add_maps on feature maps.
//   maxpool       the largest number of each window, of the pixels that lie inside the map; windows start
//                 `before` pixels outside
//   upsample_map  each pixel `stride` times in both directions; with 1 a copy
//   add_maps      act(a + b), for shortcuts that no convolution takes along
// Assumes: `border` pixels around `out` are zeroed; width, height: of the result.
// One work-item per number, channels next to each other.
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define ITEMS 64

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void maxpool(
    __global const float* restrict in, __global float* restrict out, int in_offset, int in_row,
    int in_pixel, int out_offset, int out_row, int out_pixel, int in_width, int in_height,
    int width, int height, int channels, int size, int stride, int before, int border) {
  const int id = (int)get_global_id(0);
  const int c = id % channels;
  const int x = id / channels % width;
  const int y = id / channels / width;
  if (y < height) {
    const int top = max(y * stride - before, 0);
    const int bottom = min(y * stride - before + size, in_height);
    const int left = max(x * stride - before, 0);
    const int right = min(x * stride - before + size, in_width);
    float most = -FLT_MAX;
    for (int v = top; v < bottom; ++v) {
      for (int u = left; u < right; ++u) {
        const float value = in[in_offset + v * in_row + u * in_pixel + c];
        most = value > most ? value : most;
      }
    }
    out[out_offset + y * out_row + x * out_pixel + c] = most;
  }
  clear_border_numbers(out + out_offset, id, (int)get_global_size(0), width, height, border, out_row,
                       out_pixel, channels);
}

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void upsample_map(
    __global const float* restrict in, __global float* restrict out, int in_offset, int in_row,
    int in_pixel, int out_offset, int out_row, int out_pixel, int width, int height, int channels,
    int stride, int border) {
  const int id = (int)get_global_id(0);
  const int c = id % channels;
  const int x = id / channels % width;
  const int y = id / channels / width;
  if (y < height) {
    out[out_offset + y * out_row + x * out_pixel + c] =
        in[in_offset + y / stride * in_row + x / stride * in_pixel + c];
  }
  clear_border_numbers(out + out_offset, id, (int)get_global_size(0), width, height, border, out_row,
                       out_pixel, channels);
}

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void add_maps(
    __global const float* restrict a, __global const float* restrict b, __global float* restrict out,
    int a_offset, int a_row, int a_pixel, int b_offset, int b_row, int b_pixel, int out_offset,
    int out_row, int out_pixel, int width, int height, int channels, int border, float slope,
    int activation) {
  const int id = (int)get_global_id(0);
  const int c = id % channels;
  const int x = id / channels % width;
  const int y = id / channels / width;
  if (y < height) {
    const float sum = a[a_offset + y * a_row + x * a_pixel + c] +
                      b[b_offset + y * b_row + x * b_pixel + c];
    out[out_offset + y * out_row + x * out_pixel + c] = activate(sum, slope, activation);
  }
  clear_border_numbers(out + out_offset, id, (int)get_global_size(0), width, height, border, out_row,
                       out_pixel, channels);
}
