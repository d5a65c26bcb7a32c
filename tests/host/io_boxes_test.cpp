#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/boxes.h"
#include "host/io/file.h"
#include "host/io/sequence.h"
#include "tests/devices/mutate.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using ::testing::EndsWith;
using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

TEST(Boxes, ReadsWhatBenchmarksWrite) {
  const TempFolder folder;
  write_file(folder.file("b.txt"), "205,151,17,50\n1\t2\t3.5\t4\nNaN,NaN,NaN,NaN\n-3 4 5 6\r\n");
  const auto boxes = read_boxes(folder.file("b.txt"));
  ASSERT_EQ(boxes.size(), 4u);
  EXPECT_EQ(*boxes[0], (tracking::Box{205, 151, 17, 50}));
  EXPECT_EQ(*boxes[1], (tracking::Box{1, 2, 3.5, 4}));
  EXPECT_FALSE(boxes[2]);
  EXPECT_EQ(boxes[3]->x, -3);
  write_boxes(folder.file("c.txt"), boxes);
  EXPECT_EQ(read_boxes(folder.file("c.txt")), boxes);
}

TEST(Boxes, WhatIsWrongIsNamedWithItsLine) {
  const TempFolder folder;
  const auto error_for = [&](const std::string& text) {
    write_file(folder.file("b.txt"), text);
    return error_of([&] { read_boxes(folder.file("b.txt")); });
  };
  EXPECT_THAT(error_for("1,2,3,4\n1,2,3\n"), HasSubstr("b.txt:2: 3 numbers, expected the 4"));
  EXPECT_THAT(error_for("1,2,x,4\n"), HasSubstr("b.txt:1: 'x' is not a number"));
  EXPECT_THAT(error_for("1,2,-3,4\n"), HasSubstr("b.txt:1: the box has a negative size"));
  EXPECT_THAT(error_for("1,2,nan,4\n"), HasSubstr("b.txt:1:"));
  EXPECT_THAT(error_for("\n"), HasSubstr("no boxes"));
}

TEST(Boxes, DamagedFilesEndInAnError) {
  const TempFolder folder;
  std::mt19937 random(5);
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    write_file(folder.file("b.txt"),
               testing::mutated("205,151,17,50\nnan,nan,nan,nan\n202 150 19 49\n", random));
    try {
      read_boxes(folder.file("b.txt"));
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

TEST(Boxes, MotCountsFramesFromOne) {
  const TempFolder folder;
  write_mot(folder.file("tracks.txt"), {{0, 7, {1, 2, 3, 4.005}, 0.5}, {4, 2, {-0.001, 0, 9, 9}}});
  EXPECT_EQ(read_file(folder.file("tracks.txt")),
            "1,7,1.00,2.00,3.00,4.01,0.5000,-1,-1,-1\n5,2,0.00,0.00,9.00,9.00,1.0000,-1,-1,-1\n");
}

TEST(Sequences, PicturesComeInTheirNumbersOrder) {
  const TempFolder folder;
  for (const char* name : {"10.png", "2.jpg", "0001.png", ".hidden.png", "notes.txt"}) {
    std::ofstream(folder.file(name)) << "x";
  }
  const auto paths = list_pictures(folder.file(""));
  ASSERT_EQ(paths.size(), 3u);
  EXPECT_THAT(paths[0], EndsWith("0001.png"));
  EXPECT_THAT(paths[1], EndsWith("2.jpg"));
  EXPECT_THAT(paths[2], EndsWith("10.png"));
  std::filesystem::create_directory(folder.file("img"));
  EXPECT_THAT(error_of([&] { list_pictures(folder.file("")); }), HasSubstr("img: no pictures"));
  EXPECT_THAT(error_of([&] { list_pictures(folder.file("nowhere")); }), HasSubstr("nowhere"));
}

}  // namespace
}  // namespace partita::io
