#include <cstdio>

#include "host/io/image.h"
#include "host/runtime/error.h"
#include "host/tasks/depth/depth.h"
#include "host/tasks/depth/kernels.h"

using namespace partita;

int main(int, char** argv) try {
  const sensing::GrayImage left = io::read_gray(argv[1]).image;
  const sensing::GrayImage right = io::read_gray(argv[2]).image;

  const runtime::Device device = runtime::select_device(runtime::find_devices(), "cpu");
  const runtime::Session session(device, depth::kernel_specs());
  depth::DepthParameters parameters = depth::default_parameters(left.width);
  depth::set_parameter(parameters, "lr_threshold", "1");
  depth::Depth depth(session, left.width, left.height, parameters);  // all buffers, once
  depth.warm_up();

  const depth::DisparityMap map = depth.process(left, right, 0);  // as often as there are frames
  const int x = map.width / 2, y = map.height / 2;
  if (map.valid(x, y)) std::printf("the centre's disparity is %.2f px\n", map.pixels(x, y));
  std::printf("%.1f %% of the pixels have one\n", 100 * map.density());
  return 0;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
