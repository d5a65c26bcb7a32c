// Convolution, bias, activation and shortcut (see the GPU's text for what it is).
// Assumes: as there.
// 13 pixels x 32 channels of multiply-add units. A unit's sum is due again only after the other tiles of
// its group of ten have had their turn, ten cycles, which is what a multiply-add takes: II = 1. Pixels
// and weights of 128 steps of the chain are on the chip; the next ones come in meanwhile. Curves share three
// multiply-add units: II = 6.
#include "common/fpga.clh"
#include "detection/activation.clh"
#include "detection/tensor.clh"

#define PIXELS 13
#define CHANNELS 32
#define TILES 10
#define CHUNK 128

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void convolution(
    __global const float* restrict in, __global const float* restrict weights,
    __global const float* restrict bias, __global const float* restrict residual,
    __global float* restrict out, int in_offset, int in_row, int in_pixel, int residual_offset,
    int residual_row, int residual_pixel, int out_offset, int out_row, int out_pixel, int width,
    int height, int inputs, int outputs, int size, int stride, int lanes, int border, float slope,
    int activation) {
  float pixels[PIXELS][TILES * CHUNK] PARTITION_COMPLETE(1);
  float panel[CHUNK][CHANNELS] PARTITION_COMPLETE(2);
  float acc[TILES][PIXELS][CHANNELS] PARTITION_COMPLETE(2) PARTITION_COMPLETE(3);
  const int across = (width + PIXELS - 1) / PIXELS;
  const int tiles = across * height;
  const int runs = in_pixel == inputs ? 1 : size;
  const int length = in_pixel == inputs ? size * inputs : inputs;
  for (int t0 = 0; t0 < tiles; t0 += TILES) {
    const int group = min(TILES, tiles - t0);
    __global const float* w = weights;
    for (int first = 0; first < outputs; first += lanes) {
      PIPELINE(1)
      for (int t = 0; t < group; ++t) {
        UNROLL(PIXELS)
        for (int m = 0; m < PIXELS; ++m) {
          UNROLL(CHANNELS)
          for (int c = 0; c < CHANNELS; ++c) acc[t][m][c] = c < lanes ? bias[first + c] : 0.0f;
        }
      }
      for (int ky = 0; ky < size; ++ky) {
        for (int r = 0; r < runs; ++r) {
          for (int i0 = 0; i0 < length; i0 += CHUNK) {
            const int n = min(CHUNK, length - i0);
            for (int t = 0; t < group; ++t) {
              const int y = (t0 + t) / across;
              for (int m = 0; m < PIXELS; ++m) {
                const int x = min((t0 + t) % across * PIXELS + m, width - 1);
                __global const float* p = in + in_offset + (y * stride + ky) * in_row +
                                          (x * stride + r) * in_pixel + i0;
                PIPELINE(1)
                for (int i = 0; i < n; ++i) pixels[m][t * CHUNK + i] = p[i];
              }
            }
            for (int i = 0; i < n; ++i) {
              PIPELINE(1)
              for (int c = 0; c < lanes; ++c) panel[i][c] = w[i * lanes + c];
              PIPELINE(1)
              for (int c = lanes; c < CHANNELS; ++c) panel[i][c] = 0.0f;
            }
            w += n * lanes;
            for (int i = 0; i < n; ++i) {
              PIPELINE(1)
              for (int t = 0; t < group; ++t) {
                UNROLL(PIXELS)
                for (int m = 0; m < PIXELS; ++m) {
                  UNROLL(CHANNELS)
                  for (int c = 0; c < CHANNELS; ++c) {
                    acc[t][m][c] = fma(pixels[m][t * CHUNK + i], panel[i][c], acc[t][m][c]);
                  }
                }
              }
            }
          }
        }
      }
      for (int t = 0; t < group; ++t) {
        const int y = (t0 + t) / across;
        const int x0 = (t0 + t) % across * PIXELS;
        for (int m = 0; m < min(PIXELS, width - x0); ++m) {
          __global const float* res =
              residual + residual_offset + y * residual_row + (x0 + m) * residual_pixel + first;
          __global float* o = out + out_offset + y * out_row + (x0 + m) * out_pixel + first;
          if (activation >= CURVE_RELU6) {
            PIPELINE(6)
            for (int c = 0; c < lanes; ++c) acc[t][m][c] = curve_of(acc[t][m][c], activation);
          }
          PIPELINE(1)
          for (int c = 0; c < min(lanes, outputs - first); ++c) {
            const float v = activate_line(acc[t][m][c], slope);
            o[c] = residual_pixel != 0 ? v + res[c] : v;
          }
        }
      }
    }
  }
  clear_border(out + out_offset, 0, 1, width, height, border, out_row, out_pixel, 0, outputs);
}
