// `partita track` as a user calls it.
#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;

/// A square of noise that moves to the right by 3 px a picture, as PGM files: without a picture
/// library, and small.
class Track : public ::testing::Test {
 protected:
  static constexpr int kWidth = 120, kHeight = 80, kPictures = 6;

  void SetUp() override {
    for (int k = 0; k < kPictures; ++k) write(k, 40 + 3 * k);
  }
  void write(int k, int left) const {
    std::string bytes = "P5\n120 80\n255\n";
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const int u = x - left, v = y - 30;
        const bool inside = u >= 0 && v >= 0 && u < 24 && v < 24;
        const int noise =
            inside ? (u / 4 * 37 + v / 4 * 91) % 200 + 50 : 40 + (x / 8 + y / 8) % 2 * 9;
        bytes += static_cast<char>(noise);
      }
    }
    temp_.write("seq/" + std::to_string(k + 1) + ".pgm", bytes);
  }
  Outcome track(std::vector<std::string> more) const {
    std::vector<std::string> words{"track",      "--machine",       "native", "--quiet",
                                   "--sequence", temp_.file("seq"), "-o",     out()};
    words.insert(words.end(), more.begin(), more.end());
    return partita(words);
  }
  std::string out() const { return temp_.file("boxes.txt"); }

  TempFolder temp_;
};

TEST_F(Track, FollowsAndMeasures) {
  std::string truth;
  for (int k = 0; k < kPictures; ++k) truth += std::to_string(40 + 3 * k) + ",30,24,24\n";
  temp_.write("truth.txt", truth);
  const auto json = partita_json({"track", "--machine", "native", "--quiet", "--sequence",
                                  temp_.file("seq"), "-o", out(), "--truth",
                                  temp_.file("truth.txt"), "--draw", temp_.file("drawn")});
  EXPECT_EQ(json["tracked"], kPictures);
  EXPECT_GT(json["accuracy"]["mean_iou"], 0.8);
  EXPECT_EQ(json["accuracy"]["precision_20px"], 1.0);
  EXPECT_GT(json["measured"]["frames_per_s"], 0);
  const std::string boxes = bytes_of(out());
  EXPECT_EQ(std::count(boxes.begin(), boxes.end(), '\n'), kPictures);
  EXPECT_THAT(boxes, ::testing::StartsWith("40.00,30.00,24.00,24.00\n"));
  EXPECT_EQ(std::distance(fs::directory_iterator(temp_.file("drawn")), {}), kPictures);
}

TEST_F(Track, TheSameOnEveryDeviceOfTheDragonfly) {
  std::vector<std::string> boxes;
  for (const char* device : {"cpu", "gpu", "fpga"}) {
    const auto json = partita_json({"track", "--quiet", "--sequence", temp_.file("seq"), "-o",
                                    out(), "--init", "40,30,24,24", "--device", device});
    EXPECT_GT(json["predicted"]["mean_frame_ms"], 0);
    boxes.push_back(bytes_of(out()));
  }
  EXPECT_EQ(boxes[1], boxes[0]);
  EXPECT_EQ(boxes[2], boxes[0]);
}

TEST_F(Track, ATargetThatLeavesIsSaidAndTheRestKept) {
  for (int k = 0; k < 14; ++k) write(k, 70 + 5 * k);
  const Outcome outcome = track({"--init", "70,30,24,24"});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("left the picture"));
  const std::string boxes = bytes_of(out());
  EXPECT_LT(std::count(boxes.begin(), boxes.end(), '\n'), 14);
}

TEST_F(Track, BadInputIsOneLineAndLeavesNoFile) {
  expect_one_line(track({}), 2, {"--init"});
  expect_one_line(track({"--init", "1,2,3"}), 2, {"--init"});
  expect_one_line(track({"--init", "40,30,0,24"}), 3, {"--init", "too small"});
  expect_one_line(track({"--init", "400,30,24,24"}), 3,
                  {"--init", "outside the picture", "120 x 80"});
  expect_one_line(track({"--init", "40,30,24,240"}), 3, {"larger than the picture"});
  temp_.write("truth.txt", "40,30,24,24\n40,30\n");
  expect_one_line(track({"--truth", temp_.file("truth.txt")}), 3, {"truth.txt:2"});
  temp_.write("truth.txt", "40,30,24,24\n");
  expect_one_line(track({"--truth", temp_.file("truth.txt")}), 3, {"1 boxes", "6 pictures"});
  expect_one_line(track({"--init", "40,30,24,24", "--draw", temp_.file("seq")}), 5, {"not empty"});
  fs::resize_file(temp_.file("seq/3.pgm"), 500);
  expect_one_line(track({"--init", "40,30,24,24"}), 3, {"3.pgm", "truncated"});
  temp_.write("seq/3.pgm", "P5\n2 1\n255\nxy");
  expect_one_line(track({"--init", "40,30,24,24"}), 3, {"3.pgm", "2 x 1", "120 x 80"});
  fs::remove_all(temp_.file("seq"));
  expect_one_line(track({"--init", "40,30,24,24"}), 3, {"seq", "no such folder"});
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Track, AFileThatCannotBeWritten) {
  expect_one_line(partita({"track", "--machine", "native", "--quiet", "--sequence",
                           temp_.file("seq"), "--init", "40,30,24,24", "-o", "/nowhere/b.txt"}),
                  5, {"/nowhere/b.txt"});
}

}  // namespace
}  // namespace partita::testing
