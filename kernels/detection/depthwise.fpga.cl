// Depthwise convolution (see the GPU's text for what it is).
// Assumes: as there.
// 64 channels of a pixel at a time, eight multiply-add units: a channel's sum is due again after eight
// cycles, which is what a multiply-add takes here: II = 1. The window's weights are on the chip. Curves share three
// multiply-add units: II = 6.
#include "common/fpga.clh"
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define CHANNELS 64
#define LANES 8
#define MOST_TAPS 121

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void depthwise(
    __global const float* restrict in, __global const float* restrict weights,
    __global const float* restrict bias, __global const float* restrict residual,
    __global float* restrict out, int in_offset, int in_row, int in_pixel, int residual_offset,
    int residual_row, int residual_pixel, int out_offset, int out_row, int out_pixel, int width,
    int height, int channels, int size, int stride, int border, float slope, int activation) {
  float panel[MOST_TAPS][CHANNELS] PARTITION_CYCLIC(LANES, 2);
  float start[CHANNELS] PARTITION_CYCLIC(LANES, 1);
  float acc[CHANNELS] PARTITION_CYCLIC(LANES, 1);
  for (int first = 0; first < channels; first += CHANNELS) {
    const int n = min(CHANNELS, channels - first);
    PIPELINE(1)
    for (int c = 0; c < n; ++c) start[c] = bias[first + c];
    for (int k = 0; k < size * size; ++k) {
      PIPELINE(1)
      for (int c = 0; c < n; ++c) panel[k][c] = weights[k * channels + first + c];
    }
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        __global const float* p =
            in + in_offset + y * stride * in_row + x * stride * in_pixel + first;
        for (int ky = 0; ky < size; ++ky) {
          for (int kx = 0; kx < size; ++kx) {
            PIPELINE(1)
            for (int c0 = 0; c0 < n; c0 += LANES) {
              UNROLL(LANES)
              for (int c = c0; c < min(c0 + LANES, n); ++c) {
                acc[c] = fma(p[ky * in_row + kx * in_pixel + c], panel[ky * size + kx][c],
                             ky + kx == 0 ? start[c] : acc[c]);
              }
            }
          }
        }
        __global const float* res =
            residual + residual_offset + y * residual_row + x * residual_pixel + first;
        __global float* o = out + out_offset + y * out_row + x * out_pixel + first;
        if (activation >= CURVE_RELU6) {
          PIPELINE(6)
          for (int c = 0; c < n; ++c) acc[c] = curve_of(acc[c], activation);
        }
        PIPELINE(1)
        for (int c = 0; c < n; ++c) {
          const float v = activate_line(acc[c], slope);
          o[c] = residual_pixel != 0 ? v + res[c] : v;
        }
      }
    }
  }
  clear_border(out + out_offset, 0, 1, width, height, border, out_row, out_pixel, 0, channels);
}
