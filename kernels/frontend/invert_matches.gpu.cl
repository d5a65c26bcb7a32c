// For every feature of the searched list the query that matched it best: {query, distance}, ties to
// the smaller query, or {-1, 65535}. A match is unique if its inverse leads back.
// Assumes: matches[i].x in -1 .. trains - 1; queries, trains >= 0.
// One work-item per feature of the searched list; the matches pass through local memory in tiles.
#include "frontend/common.clh"

#define GROUP 128

__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void invert_matches(
    __global const int2* restrict matches, __global int2* restrict inverse, int queries,
    int trains) {
  __local int2 tile[GROUP];
  const int lane = (int)get_local_id(0);
  const int mine = (int)get_global_id(0);
  int2 best = (int2)(-1, NO_DISTANCE);
  for (int start = 0; start < queries; start += GROUP) {
    if (start + lane < queries) tile[lane] = matches[start + lane];
    barrier(CLK_LOCAL_MEM_FENCE);
    const int filled = min(GROUP, queries - start);
    for (int i = 0; i < filled; ++i) {
      if (tile[i].x == mine && tile[i].y < best.y) best = (int2)(start + i, tile[i].y);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (mine < trains) inverse[mine] = best;
}
