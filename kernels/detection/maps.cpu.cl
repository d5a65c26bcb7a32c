// maxpool, upsample_map and add_maps (see the GPU's text for what they are).
// Assumes: as there.
// One work-item per row of the result, 16 channels at a time, then single ones.
#include "detection/activation.clh"
#include "detection/tensor.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void maxpool(
    __global const float* restrict in, __global float* restrict out, int in_offset, int in_row,
    int in_pixel, int out_offset, int out_row, int out_pixel, int in_width, int in_height,
    int width, int height, int channels, int size, int stride, int before, int border) {
  const int y = (int)get_global_id(0);
  const int top = max(y * stride - before, 0);
  const int bottom = min(y * stride - before + size, in_height);
  for (int x = 0; x < width; ++x) {
    const int left = max(x * stride - before, 0);
    const int right = min(x * stride - before + size, in_width);
    __global float* o = out + out_offset + y * out_row + x * out_pixel;
    int c = 0;
    for (; c + 16 <= channels; c += 16) {
      float16 most = (float16)(-FLT_MAX);
      for (int v = top; v < bottom; ++v) {
        __global const float* p = in + in_offset + v * in_row + c;
        for (int u = left; u < right; ++u) {
          const float16 value = vload16(0, p + u * in_pixel);
          most = value > most ? value : most;
        }
      }
      vstore16(most, 0, o + c);
    }
    for (; c < channels; ++c) {
      float most = -FLT_MAX;
      for (int v = top; v < bottom; ++v) {
        for (int u = left; u < right; ++u) {
          const float value = in[in_offset + v * in_row + u * in_pixel + c];
          most = value > most ? value : most;
        }
      }
      o[c] = most;
    }
  }
  clear_border(out + out_offset, y, height, width, height, border, out_row, out_pixel, 0, channels);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void upsample_map(
    __global const float* restrict in, __global float* restrict out, int in_offset, int in_row,
    int in_pixel, int out_offset, int out_row, int out_pixel, int width, int height, int channels,
    int stride, int border) {
  const int y = (int)get_global_id(0);
  for (int x = 0; x < width; ++x) {
    __global const float* p = in + in_offset + y / stride * in_row + x / stride * in_pixel;
    __global float* o = out + out_offset + y * out_row + x * out_pixel;
    int c = 0;
    for (; c + 16 <= channels; c += 16) vstore16(vload16(0, p + c), 0, o + c);
    for (; c < channels; ++c) o[c] = p[c];
  }
  clear_border(out + out_offset, y, height, width, height, border, out_row, out_pixel, 0, channels);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void add_maps(
    __global const float* restrict a, __global const float* restrict b, __global float* restrict out,
    int a_offset, int a_row, int a_pixel, int b_offset, int b_row, int b_pixel, int out_offset,
    int out_row, int out_pixel, int width, int height, int channels, int border, float slope,
    int activation) {
  const int y = (int)get_global_id(0);
  for (int x = 0; x < width; ++x) {
    __global const float* p = a + a_offset + y * a_row + x * a_pixel;
    __global const float* q = b + b_offset + y * b_row + x * b_pixel;
    __global float* o = out + out_offset + y * out_row + x * out_pixel;
    int c = 0;
    for (; c + 16 <= channels && activation < CURVE_RELU6; c += 16) {
      const float16 sum = vload16(0, p + c) + vload16(0, q + c);
      vstore16(sum > (float16)(0.0f) ? sum : sum * (float16)(slope), 0, o + c);
    }
    for (; c < channels; ++c) o[c] = activate(p[c] + q[c], slope, activation);
  }
  clear_border(out + out_offset, y, height, width, height, border, out_row, out_pixel, 0, channels);
}
