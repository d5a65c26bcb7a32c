// Depthwise convolution: each channel with a window of its own; bias, activation and residual as in
// `convolution`, and one chain of fma in the order ky, kx.
// Assumes: `in_offset` is the first pixel's window; weights as [ky][kx][channel]; size <= 11;
// residual_pixel 0: no residual; `border` pixels around `out` are zeroed.
// One work-item per number, channels next to each other.
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define ITEMS 64

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void depthwise(
    __global const float* restrict in, __global const float* restrict weights,
    __global const float* restrict bias, __global const float* restrict residual,
    __global float* restrict out, int in_offset, int in_row, int in_pixel, int residual_offset,
    int residual_row, int residual_pixel, int out_offset, int out_row, int out_pixel, int width,
    int height, int channels, int size, int stride, int border, float slope, int activation) {
  const int id = (int)get_global_id(0);
  const int c = id % channels;
  const int x = id / channels % width;
  const int y = id / channels / width;
  if (y < height) {
    __global const float* p = in + in_offset + y * stride * in_row + x * stride * in_pixel + c;
    float acc = bias[c];
    int k = c;
    for (int ky = 0; ky < size; ++ky) {
      for (int kx = 0; kx < size; ++kx) {
        acc = fma(p[ky * in_row + kx * in_pixel], weights[k], acc);
        k += channels;
      }
    }
    acc = activate(acc, slope, activation);
    if (residual_pixel != 0) {
      acc += residual[residual_offset + y * residual_row + x * residual_pixel + c];
    }
    out[out_offset + y * out_row + x * out_pixel + c] = acc;
  }
  clear_border_numbers(out + out_offset, id, (int)get_global_size(0), width, height, border, out_row,
                       out_pixel, channels);
}
