// The readers of text and pictures get thousands of damaged inputs: each must end in a value or in
// an Error of one line. Meant for the address sanitizer's build, and run in every other one too.

#include <gtest/gtest.h>

#include "host/io/file.h"
#include "host/io/image.h"
#include "host/io/image_check.h"
#include "host/io/labels.h"
#include "host/io/trajectory.h"
#include "host/io/truth.h"
#include "host/tasks/sensing/frame.h"
#include "host/tasks/sensing/kitti_calibration.h"
#include "host/tasks/sensing/sensor_files.h"
#include "host/tasks/sensing/stereo_calibration.h"
#include "tests/host/fuzz_text.h"
#include "tests/host/io_temp_folder.h"

namespace partita::sensing {
namespace {

using testing::TempFolder;

const std::vector<std::string> kWords = {"nan",
                                         "-",
                                         "1e999",
                                         "e",
                                         "\n",
                                         " ",
                                         "",
                                         ":",
                                         "#",
                                         "P1:",
                                         "9999999999999999999",
                                         "0x1p3",
                                         "\xff\xfe",
                                         std::string(1, '\0'),
                                         "-inf",
                                         ",",
                                         "1e-320"};

/// How many of the mutations were refused.
template <class Read>
int fuzz(const std::string& valid, int rounds, Read read) {
  return testing::refused_mutations(valid, kWords, rounds, read);
}

TEST(Fuzz, TextReaders) {
  const TempFolder folder;
  const std::string path = folder.file("input.txt");
  const auto with = [&path](auto read) {
    return [&path, read](const std::string& text) {
      io::write_file(path, text);
      read(path);
    };
  };
  constexpr int kRounds = 3000;
  const std::string row = "7.07e+02 0.0e+00 6.01e+02 0.0 0 7.07e+02 1.8e+02 0 0 0 1 0\n";
  const std::string right = "7.07e+02 0.0e+00 6.01e+02 -379.8 0 7.07e+02 1.8e+02 0 0 0 1 0\n";
  const auto calibration = with([](const std::string& p) { read_kitti_calibration(p, 0); });
  EXPECT_GT(fuzz(row + right, kRounds, calibration), kRounds / 4);
  EXPECT_GT(fuzz("P0: " + row + "P1: " + right, kRounds, calibration), kRounds / 4);
  EXPECT_GT(fuzz("cam0=[999.4 0 294.2; 0 999.4 252.9; 0 0 1]\n"
                 "cam1=[999.4 0 326.9; 0 999.4 252.9; 0 0 1]\n"
                 "doffs=32.7\nbaseline=193.0\nwidth=741\nheight=497\n",
                 kRounds / 3, with([](const auto& p) { read_stereo_calibration(p, 0); })),
            kRounds / 12);
  const std::string poses = "1 0 0 0.5 0 1 0 0.5 0 0 1 12.25\n1 0 0 0.5 0 1 0 0.5 0 0 1 13.25\n";
  EXPECT_GT(fuzz(poses, kRounds, with([](const auto& p) { io::read_kitti_trajectory(p); })),
            kRounds / 4);
  EXPECT_GT(fuzz("0.1 1 2 3 0 0 0 1\n0.2 1 2 3 0 0.6 0.8 0\n", kRounds,
                 with([](const auto& p) { io::read_tum_trajectory(p); })),
            kRounds / 4);
  EXPECT_GT(fuzz("#h\n0,1,2,3,4,5,6\n5000000,1,2,3,4,5,6\n", kRounds,
                 with([](const auto& p) { read_imu(p); })),
            kRounds / 4);
  EXPECT_GT(
      fuzz("#h\n0,1,2,3,4\n5000000,1,2,3,4\n", kRounds, with([](const auto& p) { read_gps(p); })),
      kRounds / 4);
}

TEST(Fuzz, Labels) {
  const TempFolder folder;
  const std::string path = folder.file("input.json");
  const auto with = [&path](auto read) {
    return [&path, read](const std::string& text) {
      io::write_file(path, text);
      read(path);
    };
  };
  constexpr int kRounds = 3000;
  EXPECT_GT(fuzz("Car 0.88 2 -0.69 0.00 192.37 402.31 374.00 1.60 1.57 3.23 -2.70 1.74 3.68 -1.29\n"
                 "DontCare -1 -1 -10 800.38 163.67 825.45 184.07 -1 -1 -1 -1000 -1000 -1000 -10\n",
                 kRounds, with([](const auto& p) { io::read_kitti_labels(p); })),
            kRounds / 4);
  EXPECT_GT(fuzz(R"({"images": [{"id": 7, "file_name": "a.jpg"}], "categories": [{"id": 3, "name":
                     "car"}], "annotations": [{"image_id": 7, "category_id": 3, "bbox": [1, 2, 3,
                     4], "iscrowd": 0}]})",
                 kRounds, with([](const auto& p) { io::read_coco_truth(p); })),
            kRounds / 4);
  fuzz("car\nperson\n", kRounds, with([](const auto& p) { io::read_names(p); }));
}

TEST(Fuzz, TimesThroughTheLoader) {
  const TempFolder folder;
  ScenarioOptions options;
  options.width = 64;
  options.height = 64;
  for (int i = 0; i < 3; ++i) {
    for (const char* side : {"image_0", "image_1"}) {
      const std::string name = std::string(side) + "/" + std::to_string(i) + ".png";
      folder.write(name, "");
      io::write_gray(folder.file(name), GrayImage(64, 64));
    }
  }
  folder.write("calib.txt", "70 0 30 0 0 70 30 0 0 0 1 0\n70 0 30 -35 0 70 30 0 0 0 1 0\n");
  const int refused =
      fuzz("0.000000e+00\n1.037359e-01\n2.074329e-01\n", 500, [&](const auto& text) {
        io::write_file(folder.file("times.txt"), text);
        open_kitti(folder.path());
      });
  EXPECT_GT(refused, 100);
}

/// Nor does a decoder print anything of its own.
TEST(Fuzz, Pictures) {
  const TempFolder folder;
  ::testing::internal::CaptureStderr();
  GrayImage image(24, 16);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<std::uint8_t>(i * 37);
  }
  io::write_gray(folder.file("a.png"), image);
  const std::string png = io::read_file(folder.file("a.png"));
  EXPECT_GT(fuzz(png, 2000,
                 [&](const std::string& bytes) {
                   io::write_file(folder.file("b.png"), bytes);
                   io::read_gray(folder.file("b.png"));
                 }),
            1700);
  const std::string pgm = "P5\n# a comment\n8 4\n255\n" + std::string(32, 'x');
  fuzz(pgm, 2000, [&](const std::string& bytes) {
    io::write_file(folder.file("b.pgm"), bytes);
    io::read_gray(folder.file("b.pgm"));
  });
  const std::string pfm = "Pf\n8 4\n-1.0\n" + std::string(8 * 4 * 4, 'x');
  EXPECT_GT(fuzz(pfm, 1000,
                 [&](const std::string& bytes) {
                   io::write_file(folder.file("b.pfm"), bytes);
                   io::read_truth(folder.file("b.pfm"));
                 }),
            500);
  fuzz(png, 500, [&](const std::string& bytes) {
    io::write_file(folder.file("c.png"), bytes);
    io::read_truth(folder.file("c.png"), 4);
  });
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace partita::sensing
