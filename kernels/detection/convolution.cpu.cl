// Convolution, bias, activation and shortcut (see the GPU's text for what it is).
// Assumes: width, height, inputs, outputs, size, stride, lanes as there; weights readable in whole
// blocks of `lanes`.
// One work-item computes one row of `lanes` channels, in register tiles of up to 13 pixels (13 and 10
// divide the rows of the usual networks; a last tile that would stick out is moved back and computes
// some pixels again). Weights are read once per tile, each pixel's number is broadcast.
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define UNROLLED(count) __attribute__((opencl_unroll_hint(count)))

// A tile of MR pixels x NV vectors. `p` is the first pixel's window, `step` floats from one pixel's
// window to the next one's. Where a window's row is contiguous, `runs` is 1 and `length` spans it.
#define DEFINE_TILE(NAME, MR, VECTOR, WIDTH, NV)                                                   \
  static inline __attribute__((always_inline)) void NAME(                                          \
      __global const float* p, __global const float* w,                          \
      __global const float* bias, __global const float* residual,                \
      __global float* out, int in_row, int in_pixel, int step, int size, int runs,        \
      int length, int residual_pixel, int out_pixel, int valid, float slope, int activation) {     \
    VECTOR acc[MR][NV];                                                                            \
    UNROLLED(MR) for (int m = 0; m < MR; ++m) {                                                    \
      UNROLLED(NV) for (int v = 0; v < NV; ++v) acc[m][v] = vload##WIDTH(0, bias + v * WIDTH);                 \
    }                                                                                              \
    for (int ky = 0; ky < size; ++ky) {                                                            \
      for (int r = 0; r < runs; ++r) {                                                             \
        __global const float* q = p + ky * in_row + r * in_pixel;                                  \
        for (int i = 0; i < length; ++i) {                                                         \
          VECTOR weight[NV];                                                                       \
          UNROLLED(NV) for (int v = 0; v < NV; ++v) weight[v] = vload##WIDTH(0, w + v * WIDTH);                \
          UNROLLED(MR) for (int m = 0; m < MR; ++m) {                                              \
            const VECTOR a = (VECTOR)(q[i + m * step]);                                            \
            UNROLLED(NV) for (int v = 0; v < NV; ++v) {                                            \
              acc[m][v] = fma(a, weight[v], acc[m][v]);                                            \
            }                                                                                      \
          }                                                                                        \
          w += WIDTH * NV;                                                                         \
        }                                                                                          \
      }                                                                                            \
    }                                                                                              \
    if (valid == WIDTH * NV && activation < CURVE_RELU6) {                                         \
      UNROLLED(MR) for (int m = 0; m < MR; ++m) {                                                  \
        UNROLLED(NV) for (int v = 0; v < NV; ++v) {                                                \
          VECTOR y = acc[m][v] > (VECTOR)(0.0f) ? acc[m][v] : acc[m][v] * (VECTOR)(slope);         \
          if (residual_pixel != 0) y += vload##WIDTH(0, residual + m * residual_pixel + v * WIDTH);            \
          vstore##WIDTH(y, 0, out + m * out_pixel + v * WIDTH);                                                \
        }                                                                                          \
      }                                                                                            \
      return;                                                                                      \
    }                                                                                              \
    float tile[MR * NV * WIDTH];                                                                   \
    UNROLLED(MR) for (int m = 0; m < MR; ++m) {                                                    \
      UNROLLED(NV) for (int v = 0; v < NV; ++v) vstore##WIDTH(acc[m][v], 0, tile + (m * NV + v) * WIDTH);        \
    }                                                                                              \
    for (int m = 0; m < MR; ++m) {                                                                 \
      for (int c = 0; c < valid; ++c) {                                                            \
        float y = activate(tile[m * NV * WIDTH + c], slope, activation);                           \
        if (residual_pixel != 0) y += residual[m * residual_pixel + c];                            \
        out[m * out_pixel + c] = y;                                                                \
      }                                                                                            \
    }                                                                                              \
  }

DEFINE_TILE(tile_13x32, 13, float16, 16, 2)
DEFINE_TILE(tile_10x32, 10, float16, 16, 2)
DEFINE_TILE(tile_4x32, 4, float16, 16, 2)
DEFINE_TILE(tile_1x32, 1, float16, 16, 2)
DEFINE_TILE(tile_13x16, 13, float16, 16, 1)
DEFINE_TILE(tile_10x16, 10, float16, 16, 1)
DEFINE_TILE(tile_4x16, 4, float16, 16, 1)
DEFINE_TILE(tile_1x16, 1, float16, 16, 1)
DEFINE_TILE(tile_13x8, 13, float8, 8, 1)
DEFINE_TILE(tile_10x8, 10, float8, 8, 1)
DEFINE_TILE(tile_4x8, 4, float8, 8, 1)
DEFINE_TILE(tile_1x8, 1, float8, 8, 1)

// Work of a row in tiles of `tile` pixels: those computed, and what a tile costs beside them.
static inline int row_cost(int width, int tile) {
  return width < tile ? INT_MAX : (width + tile - 1) / tile * (2 * tile + 3);
}

static inline int best_tile(int width) {
  int best = 1;
  if (row_cost(width, 4) < row_cost(width, best)) best = 4;
  if (row_cost(width, 10) < row_cost(width, best)) best = 10;
  if (row_cost(width, 13) < row_cost(width, best)) best = 13;
  return best;
}

#define ROW_OF(TILE, MR)                                                                           \
  for (int x0 = 0; x0 < width; x0 += MR) {                                                         \
    const int x = min(x0, width - MR);                                                             \
    TILE(p + x * step, w, b, residual_start + x * residual_pixel, out_start + x * out_pixel,     \
         in_row, in_pixel, step, size, runs, length, residual_pixel, out_pixel, valid, slope,      \
         activation);                                                                              \
  }

#define ROWS_OF(LANES)                                                                             \
  switch (best_tile(width)) {                                                                      \
    case 13:                                                                                       \
      ROW_OF(tile_13x##LANES, 13)                                                                  \
      break;                                                                                       \
    case 10:                                                                                       \
      ROW_OF(tile_10x##LANES, 10)                                                                  \
      break;                                                                                       \
    case 4:                                                                                        \
      ROW_OF(tile_4x##LANES, 4)                                                                    \
      break;                                                                                       \
    default:                                                                                       \
      ROW_OF(tile_1x##LANES, 1)                                                                    \
  }

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void convolution(
    __global const float* restrict in, __global const float* restrict weights,
    __global const float* restrict bias, __global const float* restrict residual,
    __global float* restrict out, int in_offset, int in_row, int in_pixel, int residual_offset,
    int residual_row, int residual_pixel, int out_offset, int out_row, int out_pixel, int width,
    int height, int inputs, int outputs, int size, int stride, int lanes, int border, float slope,
    int activation) {
  const int blocks = (outputs + lanes - 1) / lanes;
  const int chain = size * size * inputs;
  // What is larger, input or weights, is gone through once.
  const int rows_first = size * size * outputs > width * height * stride * stride;
  const int id = (int)get_global_id(0);
  const int y = rows_first ? id % height : id / blocks;
  const int block = rows_first ? id / height : id % blocks;
  const int first = block * lanes;
  const int valid = min(lanes, outputs - first);
  const int runs = in_pixel == inputs ? 1 : size;
  const int length = in_pixel == inputs ? size * inputs : inputs;
  const int step = stride * in_pixel;
  __global const float* p = in + in_offset + y * stride * in_row;
  __global const float* w = weights + (size_t)block * (size_t)(chain * lanes);
  __global const float* b = bias + first;
  __global const float* residual_start = residual + residual_offset + y * residual_row + first;
  __global float* out_start = out + out_offset + y * out_row + first;
  if (lanes == 32) {
    ROWS_OF(32)
  } else if (lanes == 16) {
    ROWS_OF(16)
  } else {
    ROWS_OF(8)
  }
  clear_border(out + out_offset, y, height, width, height, border, out_row, out_pixel, first,
               first + valid);
}
