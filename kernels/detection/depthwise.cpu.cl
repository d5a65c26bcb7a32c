// Depthwise convolution (see the GPU's text for what it is).
// Assumes: as there.
// One work-item computes one row, 16 channels at a time with their weights in registers, then 8, then
// single ones.
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define MOST_TAPS 25
#define UNROLLED(count) __attribute__((opencl_unroll_hint(count)))
#define LOAD1(p) (*(p))
#define STORE1(v, p) (*(p) = (v))
#define LOAD8(p) vload8(0, p)
#define STORE8(v, p) vstore8(v, 0, p)
#define LOAD16(p) vload16(0, p)
#define STORE16(v, p) vstore16(v, 0, p)

// A row of one vector of channels, for a window of SIDE x SIDE.
#define DEFINE_ROW(NAME, SIDE, VECTOR, WIDTH)                                                      \
  static inline __attribute__((always_inline)) void NAME(                                          \
      __global const float* in, __global const float* weights, VECTOR start,     \
      __global const float* residual, __global float* out, int channels,         \
      int in_row, int in_pixel, int step, int residual_pixel, int out_pixel, int width,            \
      float slope) {                                                                               \
    VECTOR w[SIDE * SIDE];                                                                         \
    UNROLLED(SIDE * SIDE) for (int k = 0; k < SIDE * SIDE; ++k) {                                  \
      w[k] = LOAD##WIDTH(weights + k * channels);                                                  \
    }                                                                                              \
    for (int x = 0; x < width; ++x) {                                                              \
      __global const float* p = in + x * step;                                                     \
      VECTOR acc = start;                                                                          \
      UNROLLED(SIDE) for (int ky = 0; ky < SIDE; ++ky) {                                           \
        UNROLLED(SIDE) for (int kx = 0; kx < SIDE; ++kx) {                                         \
          acc = fma(LOAD##WIDTH(p + ky * in_row + kx * in_pixel), w[ky * SIDE + kx], acc);         \
        }                                                                                          \
      }                                                                                            \
      acc = acc > (VECTOR)(0.0f) ? acc : acc * (VECTOR)(slope);                                    \
      if (residual_pixel != 0) acc += LOAD##WIDTH(residual + x * residual_pixel);                  \
      STORE##WIDTH(acc, out + x * out_pixel);                                                      \
    }                                                                                              \
  }

DEFINE_ROW(row_3x16, 3, float16, 16)
DEFINE_ROW(row_3x8, 3, float8, 8)
DEFINE_ROW(row_3x1, 3, float, 1)
DEFINE_ROW(row_5x16, 5, float16, 16)
DEFINE_ROW(row_5x8, 5, float8, 8)
DEFINE_ROW(row_5x1, 5, float, 1)

#define ROW_OF(NAME, WIDTH)                                                                        \
  NAME(p + c, weights + c, LOAD##WIDTH(bias + c), r + c, o + c, channels, in_row, in_pixel, step,  \
       residual_pixel, out_pixel, width, slope)

#define ALL_CHANNELS(SIDE)                                                                         \
  {                                                                                                \
    int c = 0;                                                                                     \
    for (; c + 16 <= channels; c += 16) ROW_OF(row_##SIDE##x16, 16);                               \
    for (; c + 8 <= channels; c += 8) ROW_OF(row_##SIDE##x8, 8);                                   \
    for (; c < channels; ++c) ROW_OF(row_##SIDE##x1, 1);                                           \
  }

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void depthwise(
    __global const float* restrict in, __global const float* restrict weights,
    __global const float* restrict bias, __global const float* restrict residual,
    __global float* restrict out, int in_offset, int in_row, int in_pixel, int residual_offset,
    int residual_row, int residual_pixel, int out_offset, int out_row, int out_pixel, int width,
    int height, int channels, int size, int stride, int border, float slope, int activation) {
  const int y = (int)get_global_id(0);
  const int step = stride * in_pixel;
  __global const float* p = in + in_offset + y * stride * in_row;
  __global const float* r = residual + residual_offset + y * residual_row;
  __global float* o = out + out_offset + y * out_row;
  if (size == 3 && activation < CURVE_RELU6) {
    ALL_CHANNELS(3)
  } else if (size == 5 && activation < CURVE_RELU6) {
    ALL_CHANNELS(5)
  } else {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        float acc = bias[c];
        for (int k = 0; k < size * size; ++k) {
          const int tap = k / size * in_row + k % size * in_pixel;
          acc = fma(p[x * step + tap + c], weights[k * channels + c], acc);
        }
        acc = activate(acc, slope, activation);
        if (residual_pixel != 0) acc += r[x * residual_pixel + c];
        o[x * out_pixel + c] = acc;
      }
    }
  }
  clear_border(out + out_offset, y, height, width, height, border, out_row, out_pixel, 0, channels);
}
