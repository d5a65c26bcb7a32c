// What a device can do at most, for shares of its roofline: multiply-adds in registers, and a copy.
// Assumes: `numbers` a multiple of 16 per work-item; local size 1.

#define CHAINS 12

// `rounds` multiply-adds in each of 12 independent chains of 16 numbers.
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void peak_fma(__global float* restrict out,
                                                                      float factor, int rounds) {
  float16 sums[CHAINS];
  __attribute__((opencl_unroll_hint(CHAINS)))
  for (int i = 0; i < CHAINS; ++i) sums[i] = (float16)(factor + (float)i);
  for (int r = 0; r < rounds; ++r) {
    __attribute__((opencl_unroll_hint(CHAINS)))
    for (int i = 0; i < CHAINS; ++i) sums[i] = fma(sums[i], (float16)(factor), (float16)(factor));
  }
  float16 sum = (float16)(0.0f);
  __attribute__((opencl_unroll_hint(CHAINS)))
  for (int i = 0; i < CHAINS; ++i) sum += sums[i];
  vstore16(sum, get_global_id(0), out);
}

// Each work-item copies `numbers` next to each other.
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void peak_copy(
    __global const float* restrict in, __global float* restrict out, int numbers) {
  const size_t first = get_global_id(0) * (size_t)numbers;
  for (int i = 0; i < numbers; i += 16) vstore16(vload16(0, in + first + i), 0, out + first + i);
}
