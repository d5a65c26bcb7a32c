// maxpool, upsample_map and add_maps (see the GPU's text for what they are).
// Assumes: as there.
// Pixel by pixel, channels streaming. The largest numbers so far of 64 channels are on the chip; nothing
// else is carried between iterations: II = 1. Curves share three multiply-add units: II = 6.
#include "common/fpga.clh"
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define CHANNELS 64

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void maxpool(
    __global const float* restrict in, __global float* restrict out, int in_offset, int in_row,
    int in_pixel, int out_offset, int out_row, int out_pixel, int in_width, int in_height,
    int width, int height, int channels, int size, int stride, int before, int border) {
  float most[CHANNELS];
  for (int y = 0; y < height; ++y) {
    const int top = max(y * stride - before, 0);
    const int bottom = min(y * stride - before + size, in_height);
    for (int x = 0; x < width; ++x) {
      const int left = max(x * stride - before, 0);
      const int right = min(x * stride - before + size, in_width);
      __global float* o = out + out_offset + y * out_row + x * out_pixel;
      for (int first = 0; first < channels; first += CHANNELS) {
        const int n = min(CHANNELS, channels - first);
        PIPELINE(1)
        for (int c = 0; c < n; ++c) most[c] = -FLT_MAX;
        for (int v = top; v < bottom; ++v) {
          for (int u = left; u < right; ++u) {
            __global const float* p = in + in_offset + v * in_row + u * in_pixel + first;
            PIPELINE(1)
            for (int c = 0; c < n; ++c) most[c] = p[c] > most[c] ? p[c] : most[c];
          }
        }
        PIPELINE(1)
        for (int c = 0; c < n; ++c) o[first + c] = most[c];
      }
    }
  }
  clear_border(out + out_offset, 0, 1, width, height, border, out_row, out_pixel, 0, channels);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void upsample_map(
    __global const float* restrict in, __global float* restrict out, int in_offset, int in_row,
    int in_pixel, int out_offset, int out_row, int out_pixel, int width, int height, int channels,
    int stride, int border) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      __global const float* p = in + in_offset + y / stride * in_row + x / stride * in_pixel;
      __global float* o = out + out_offset + y * out_row + x * out_pixel;
      PIPELINE(1)
      for (int c = 0; c < channels; ++c) o[c] = p[c];
    }
  }
  clear_border(out + out_offset, 0, 1, width, height, border, out_row, out_pixel, 0, channels);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void add_maps(
    __global const float* restrict a, __global const float* restrict b, __global float* restrict out,
    int a_offset, int a_row, int a_pixel, int b_offset, int b_row, int b_pixel, int out_offset,
    int out_row, int out_pixel, int width, int height, int channels, int border, float slope,
    int activation) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      __global const float* p = a + a_offset + y * a_row + x * a_pixel;
      __global const float* q = b + b_offset + y * b_row + x * b_pixel;
      __global float* o = out + out_offset + y * out_row + x * out_pixel;
      if (activation >= CURVE_RELU6) {
        PIPELINE(6)
        for (int c = 0; c < channels; ++c) o[c] = curve_of(p[c] + q[c], activation);
      } else {
        PIPELINE(1)
        for (int c = 0; c < channels; ++c) o[c] = activate_line(p[c] + q[c], slope);
      }
    }
  }
  clear_border(out + out_offset, 0, 1, width, height, border, out_row, out_pixel, 0, channels);
}
