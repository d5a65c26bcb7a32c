// Convolution with bias (batch normalisation is folded into it and the weights), activation and, after
// it, the sum with an earlier map (a Darknet shortcut):
//   out(x, y, c) = act(bias[c] + sum over ky, kx, i of in(x s + kx, y s + ky, i) w[c][ky][kx][i]) + res(x, y, c)
// The sum is one chain of fma in that order, starting with the bias.
// Assumes: `in_offset` is the first pixel's window, so that what a window needs of the border is there
// (zeros); weights as [block][ky][kx][input][lane], blocks of `lanes` outputs (8, 16 or 32), the last one
// filled up, bias too; residual_pixel 0: no residual; `border` pixels around `out` are zeroed.
// Groups of 64 compute 64 pixels x 64 channels (32, 16, 8 where there are fewer, or too few tiles to fill
// a device), 8 x 8 per work-item; eight steps of the chain at a time go through local memory.
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define ITEMS 64
#define PIXELS 64
#define STEPS 8
#define EACH (PIXELS / 8)
#define TILES_TO_FILL 120

// A group's tile, CH channels per work-item.
#define DEFINE_TILE(NAME, CH)                                                                      \
  static inline __attribute__((always_inline)) void NAME(                                          \
      __local float* pixels, __local float* channels, __global const float* in,           \
      __global const float* weights, __global const float* bias,                 \
      __global const float* residual, __global float* out, int in_row,           \
      int in_pixel, int residual_row, int residual_pixel, int out_row, int out_pixel, int width,   \
      int height, int inputs, int outputs, int size, int stride, int lanes, int border,            \
      float slope, int activation) {                                                               \
    const int item = (int)get_local_id(0);                                                         \
    const int tiles = (width * height + PIXELS - 1) / PIXELS;                                      \
    const int tile = (int)get_group_id(0) % tiles;                                                 \
    const int first = (int)get_group_id(0) / tiles * (8 * CH);                                     \
    const int last_channel = (outputs + lanes - 1) / lanes * lanes - 1;                            \
    const int runs = in_pixel == inputs ? 1 : size;                                                \
    const int length = in_pixel == inputs ? size * inputs : inputs;                                \
    /* What this work-item brings into local memory. */                                            \
    const int loaded = min(tile * PIXELS + item, width * height - 1);                              \
    __global const float* window =                                                                 \
        in + loaded / width * stride * in_row + loaded % width * stride * in_pixel;                \
    const int channel = min(first + item % (8 * CH), last_channel);                                \
    __global const float* w =                                                                      \
        weights + channel / lanes * (size * size * inputs * lanes) + channel % lanes;              \
    const int column = item % 8 * CH;                                                              \
    const int line = item / 8 * EACH;                                                              \
    float acc[EACH][CH];                                                                           \
    for (int c = 0; c < CH; ++c) {                                                                 \
      const float b = bias[min(first + column + c, last_channel)];                                 \
      for (int m = 0; m < EACH; ++m) acc[m][c] = b;                                                \
    }                                                                                              \
    for (int ky = 0; ky < size; ++ky) {                                                            \
      for (int r = 0; r < runs; ++r) {                                                             \
        for (int i = 0; i < length; i += STEPS) {                                                  \
          const int n = min(STEPS, length - i);                                                    \
          __global const float* p = window + ky * in_row + r * in_pixel + i;                       \
          for (int k = 0; k < n; ++k) pixels[k * PIXELS + item] = p[k];                            \
          for (int k = item / (8 * CH); k < n; k += ITEMS / (8 * CH)) {                            \
            channels[k * 8 * CH + item % (8 * CH)] = w[k * lanes];                                 \
          }                                                                                        \
          w += n * lanes;                                                                          \
          barrier(CLK_LOCAL_MEM_FENCE);                                                            \
          for (int k = 0; k < n; ++k) {                                                            \
            float a[EACH];                                                                         \
            for (int m = 0; m < EACH; ++m) a[m] = pixels[k * PIXELS + line + m];                   \
            for (int c = 0; c < CH; ++c) {                                                         \
              const float b = channels[k * 8 * CH + column + c];                                   \
              for (int m = 0; m < EACH; ++m) acc[m][c] = fma(a[m], b, acc[m][c]);                  \
            }                                                                                      \
          }                                                                                        \
          barrier(CLK_LOCAL_MEM_FENCE);                                                            \
        }                                                                                          \
      }                                                                                            \
    }                                                                                              \
    for (int m = 0; m < EACH; ++m) {                                                               \
      const int pixel = tile * PIXELS + line + m;                                                  \
      const int y = pixel / width;                                                                 \
      const int x = pixel % width;                                                                 \
      for (int c = 0; c < CH; ++c) {                                                               \
        const int output = first + column + c;                                                     \
        if (y < height && output < outputs) {                                                      \
          float v = activate(acc[m][c], slope, activation);                                        \
          if (residual_pixel != 0) v += residual[y * residual_row + x * residual_pixel + output];  \
          out[y * out_row + x * out_pixel + output] = v;                                           \
        }                                                                                          \
      }                                                                                            \
    }                                                                                              \
    const int around = border_pixels(width, height, border);                                       \
    for (int i = tile; i < around; i += tiles) {                                                   \
      const int at = border_pixel(i, width, height, border, out_row, out_pixel);                   \
      for (int c = first + item; c < min(first + 8 * CH, outputs); c += ITEMS) out[at + c] = 0.0f; \
    }                                                                                              \
  }

DEFINE_TILE(tile_64, 8)
DEFINE_TILE(tile_32, 4)
DEFINE_TILE(tile_16, 2)
DEFINE_TILE(tile_8, 1)

#define TILE_OF(NAME)                                                                             \
  NAME(pixels, channels, in + in_offset, weights, bias, residual + residual_offset,               \
       out + out_offset, in_row, in_pixel, residual_row, residual_pixel, out_row, out_pixel,      \
       width, height, inputs, outputs, size, stride, lanes, border, slope, activation)

__kernel __attribute__((reqd_work_group_size(ITEMS, 1, 1))) void convolution(
    __global const float* restrict in, __global const float* restrict weights,
    __global const float* restrict bias, __global const float* restrict residual,
    __global float* restrict out, int in_offset, int in_row, int in_pixel, int residual_offset,
    int residual_row, int residual_pixel, int out_offset, int out_row, int out_pixel, int width,
    int height, int inputs, int outputs, int size, int stride, int lanes, int border, float slope,
    int activation) {
  __local float pixels[STEPS * PIXELS];
  __local float channels[STEPS * 64];
  const int large = (width * height + PIXELS - 1) / PIXELS * ((outputs + 63) / 64);
  if (outputs > 32 && large >= TILES_TO_FILL) {
    TILE_OF(tile_64);
  } else if (outputs > 16) {
    TILE_OF(tile_32);
  } else if (outputs > 8) {
    TILE_OF(tile_16);
  } else {
    TILE_OF(tile_8);
  }
}
