// A kernel with a planted write out of bounds: Oclgrind has to object, or the runs of the real
// kernels under it prove nothing. CTest looks for its objection.
#include <gtest/gtest.h>

#include <CL/opencl.hpp>

TEST(CanarySmall, WritesOutOfBounds) {
  const cl::Context context(cl::Device::getDefault());
  cl::Program program(context,
                      "__kernel void bad(__global int *a, int n) { a[n + get_global_id(0)] = 1; }");
  program.build();
  const cl::CommandQueue queue(context, cl::Device::getDefault());
  const cl::Buffer buffer(context, CL_MEM_READ_WRITE, 16 * sizeof(cl_int));
  cl::Kernel kernel(program, "bad");
  kernel.setArg(0, buffer);
  kernel.setArg(1, cl_int{16});
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
  queue.finish();
}
