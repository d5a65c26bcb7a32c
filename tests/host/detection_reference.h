// The networks of the test data, with random weights where they have none, and OpenCV's answer.
#ifndef PARTITA_TESTS_HOST_DETECTION_REFERENCE_H
#define PARTITA_TESTS_HOST_DETECTION_REFERENCE_H

#include <string>
#include <vector>

#include "host/io/darknet.h"

namespace partita::testing {

struct TestNetwork {
  const char* name;
  const char* cfg;      ///< below PARTITA_DATA/detect
  const char* weights;  ///< empty: random ones
  int side = 0;         ///< 0: as in the cfg
};

/// All of them; those of many weights on small pictures.
const std::vector<TestNetwork>& test_networks();

struct LoadedNetwork {
  io::darknet::Model model;
  io::darknet::Weights weights;
  std::string cfg_text, weight_bytes;  ///< for OpenCV
};
LoadedNetwork load(const TestNetwork& network, const std::string& data_folder);

/// Numbers from 0 to 1, smooth enough to be a picture: [y][x][channel].
std::vector<float> test_picture(const io::darknet::Extent& size);

}  // namespace partita::testing

#endif  // PARTITA_TESTS_HOST_DETECTION_REFERENCE_H
