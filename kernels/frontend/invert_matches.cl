// The inverse of a list of matches (see the GPU's text for what it is), for CPU and FPGA.
// Assumes: matches[i].x in -1 .. trains - 1; trains <= 2048.
// A single work-item passes over the matches once. On the FPGA a read, a compare and a write of the
// same memory follow each other, and two matches in a row may hit the same entry: II = 2 for an
// on-chip memory, which is cleared before and copied out behind.
#include "common/fpga.clh"
#include "frontend/common.clh"

#define MAX_TRAINS 2048

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void invert_matches(
    __global const int2* restrict matches, __global int2* restrict inverse, int queries,
    int trains) {
  int2 best[MAX_TRAINS];
  PIPELINE(1)
  for (int i = 0; i < trains; ++i) best[i] = (int2)(-1, NO_DISTANCE);
  PIPELINE(2)
  for (int i = 0; i < queries; ++i) {
    const int2 match = matches[i];
    if (match.x >= 0 && match.y < best[match.x].y) best[match.x] = (int2)(i, match.y);
  }
  PIPELINE(1)
  for (int i = 0; i < trains; ++i) inverse[i] = best[i];
}
