// partita depth as a user calls it: every output, the accuracy figures, and what bad pictures and
// odd options are answered with.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "host/io/image.h"
#include "host/io/pfm.h"
#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;
using sensing::GrayImage;
using ::testing::HasSubstr;
using ::testing::Not;

/// One pair of the built-in street with its truth, made once.
class DepthCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const Outcome made = partita({"generate", "--out", folder_->file("street"), "--frames", "1",
                                  "--width", "480", "--height", "270", "--quiet"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string street(const std::string& name) { return folder_->file("street/" + name); }
  static std::string left() { return street("image_0/000000.png"); }
  static std::string right() { return street("image_1/000000.png"); }
  static std::string truth() { return street("disparity/000000.png"); }

  static Outcome depth(std::vector<std::string> words) {
    words.insert(words.begin(), "depth");
    return partita(words);
  }
  static nlohmann::json depth_json(std::vector<std::string> words) {
    words.insert(words.begin(), "depth");
    return partita_json(words);
  }
  std::string picture(const std::string& name, const GrayImage& image) const {
    io::write_gray(temp_.file(name), image);
    return temp_.file(name);
  }

  static inline TempFolder* folder_ = nullptr;
  TempFolder temp_;
};

TEST_F(DepthCommand, WritesTheSameMapInEveryFormat) {
  const std::string png = temp_.file("d.png"), pfm = temp_.file("d.pfm"),
                    view = temp_.file("v.png");
  const auto json = depth_json({left(), right(), "-o", png, "--colour", view});
  EXPECT_EQ(depth_json({left(), right(), "-o", pfm})["density"], json["density"]);
  const sensing::FloatImage map = io::read_disparity(png);
  EXPECT_EQ(map, io::read_pfm(pfm));
  EXPECT_EQ(map.width, 480);
  EXPECT_EQ(map.height, 270);
  const auto known =
      std::count_if(map.pixels.begin(), map.pixels.end(), [](float d) { return d > 0; });
  EXPECT_NEAR(static_cast<double>(known) / (480 * 270), json["density"], 1e-12);
  EXPECT_EQ(cv::imread(view).size(), cv::Size(480, 270 + 44));  // the colour bar is below
  EXPECT_EQ(json["files"], (std::vector<std::string>{png, view}));
  EXPECT_TRUE(json["warnings"].empty()) << json["warnings"];
}

TEST_F(DepthCommand, SaysHowGoodItIs) {
  const auto json = depth_json({left(), right(), "--truth", truth()});
  const auto& accuracy = json["accuracy"];
  EXPECT_EQ(accuracy["format"], "16 bit, 256 levels a pixel");
  EXPECT_GT(accuracy["density"], 0.6);
  EXPECT_LT(accuracy["bad3_percent"], 10);
  EXPECT_LE(accuracy["bad3_percent"], accuracy["bad1_percent"]);
  EXPECT_LT(accuracy["mean_error_px"], 2);
  EXPECT_GT(accuracy["pixels_compared"], 480 * 270 / 2);
  const Outcome text = depth({left(), right(), "--truth", truth()});
  for (const char* word : {"density", "bad-1", "bad-3", "mean error"}) {
    EXPECT_THAT(text.out, HasSubstr(word));
  }
  // Twice the levels a pixel are half the disparities: the truth is wrong then.
  EXPECT_GT(depth_json({left(), right(), "--truth", truth(), "--truth-scale",
                        "512"})["accuracy"]["bad1_percent"],
            50);
  // A mask of the left half.
  GrayImage mask(480, 270);
  for (int y = 0; y < 270; ++y) std::fill_n(mask.row(y), 240, std::uint8_t{255});
  const auto masked =
      depth_json({left(), right(), "--truth", truth(), "--mask", picture("mask.png", mask)});
  EXPECT_LT(masked["accuracy"]["pixels_with_truth"], accuracy["pixels_with_truth"]);
  EXPECT_GT(masked["accuracy"]["pixels_with_truth"], 0);
}

TEST_F(DepthCommand, ACloudNeedsACalibration) {
  const std::string ply = temp_.file("points.ply");
  expect_one_line(depth({left(), right(), "--cloud", ply}), 2, {"--calib", "--focal"});
  expect_one_line(depth({left(), right(), "--calib", street("calib.txt")}), 2, {"--cloud"});
  expect_one_line(
      depth({left(), right(), "--cloud", ply, "--calib", street("calib.txt"), "--cx", "3"}), 2,
      {"--calib"});
  expect_one_line(depth({left(), right(), "--cloud", ply, "--calib", street("times.txt")}), 3,
                  {"times.txt"});
  EXPECT_FALSE(fs::exists(ply));
  EXPECT_EQ(depth({left(), right(), "--cloud", ply, "--calib", street("calib.txt")}).status, 0);
  const std::string by_file = bytes_of(ply);
  EXPECT_THAT(by_file, HasSubstr("element vertex"));
  EXPECT_EQ(depth({left(), right(), "--cloud", ply, "--focal", "240", "--baseline", "0.5"}).status,
            0);
  EXPECT_NE(bytes_of(ply), by_file);
}

TEST_F(DepthCommand, ParametersAreSetByName) {
  const auto json = depth_json({left(), right(), "--setting", "middlebury", "--set",
                                "lr_threshold=1", "--set", "beta=0.03", "--max-disparity", "63"});
  EXPECT_EQ(json["setting"], "middlebury");
  EXPECT_EQ(json["parameters"]["lr_threshold"], 1);
  EXPECT_EQ(json["parameters"]["beta"], 0.03);
  EXPECT_EQ(json["parameters"]["max_disparity"], 63);
  EXPECT_EQ(json["parameters"]["support_threshold"], 0.95);
  expect_one_line(depth({left(), right(), "--set", "lr_threshold"}), 2, {"name=value"});
  expect_one_line(depth({left(), right(), "--set", "lr=1"}), 2, {"'lr'", "lr_threshold"});
  expect_one_line(depth({left(), right(), "--set", "beta=nan"}), 2, {"beta", "0.001"});
  expect_one_line(depth({left(), right(), "--setting", "kitti"}), 2, {"robotics", "middlebury"});
  const auto table = depth_json({"--parameters"});
  EXPECT_GT(table["parameters"].size(), 15u);
  EXPECT_THAT(depth({"--parameters"}).out, HasSubstr("support_threshold"));
}

TEST_F(DepthCommand, AnEmulatedDevicePredictsAndGivesTheSameMap) {
  const std::string native = temp_.file("native.png"), emulated = temp_.file("emulated.png");
  const auto here = depth_json({left(), right(), "-o", native, "--repeat", "3"});
  EXPECT_FALSE(here.contains("predicted"));
  EXPECT_EQ(here["measured"]["each_ms"].size(), 3u);
  for (const char* device : {"gpu", "fpga"}) {
    const std::vector<std::string> words{left(), right(),     "-o",       emulated,
                                         "-m",   "dragonfly", "--device", device};
    const auto json = depth_json(words);
    EXPECT_EQ(bytes_of(emulated), bytes_of(native)) << device;
    EXPECT_EQ(json["charged_variant"], device);
    EXPECT_GT(json["predicted"]["ms"], 0.1);
    EXPECT_EQ(depth_json(words)["predicted"], json["predicted"]);
  }
}

TEST_F(DepthCommand, OtherPicturesAreConvertedAndThatIsSaid) {
  cv::Mat colour = cv::imread(left(), cv::IMREAD_COLOR), deep = cv::imread(right(), 0);
  deep.convertTo(deep, CV_16U, 257);
  ASSERT_TRUE(cv::imwrite(temp_.file("colour.png"), colour));
  ASSERT_TRUE(cv::imwrite(temp_.file("deep.png"), deep));
  const Outcome outcome =
      depth({temp_.file("colour.png"), temp_.file("deep.png"), "-o", temp_.file("c.png")});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("colour.png: colour, converted"));
  EXPECT_THAT(outcome.err, HasSubstr("deep.png: 16-bit, converted"));
  EXPECT_EQ(depth({left(), right(), "-o", temp_.file("g.png")}).status, 0);
  EXPECT_EQ(bytes_of(temp_.file("c.png")), bytes_of(temp_.file("g.png")));
  const cv::Mat ten_bits = deep / 64;  // as a camera delivers them: the upper six bits are empty
  ASSERT_TRUE(cv::imwrite(temp_.file("ten.png"), ten_bits));
  EXPECT_THAT(depth({temp_.file("ten.png"), right()}).err, HasSubstr("levels up to 3"));
}

TEST_F(DepthCommand, PicturesThatCannotBeMatchedAreErrors) {
  const std::string other = picture("other.png", GrayImage(480, 200));
  expect_one_line(depth({left(), other, "-o", temp_.file("d.png")}), 3,
                  {left(), other, "480 x 200", "one size"});
  const std::string tiny = picture("tiny.png", GrayImage(20, 10));
  expect_one_line(depth({tiny, tiny}), 3, {"20 x 10", "32 x 16"});
  const std::string narrow = picture("narrow.png", GrayImage(64, 64));
  expect_one_line(depth({narrow, narrow, "--max-disparity", "64"}), 3, {"max_disparity", "64"});
  expect_one_line(depth({left(), temp_.file("none.png")}), 3, {"none.png"});
  expect_one_line(depth({left(), right(), "--truth", other}), 3, {other});
  io::write_disparity(temp_.file("t.png"), sensing::FloatImage(10, 10, 3));
  expect_one_line(depth({left(), right(), "--truth", temp_.file("t.png")}), 3,
                  {"t.png", "10 x 10", "480 x 270"});
  EXPECT_FALSE(fs::exists(temp_.file("d.png")));
}

/// Nothing to match: an empty map, a warning that says why, no invented depth.
TEST_F(DepthCommand, WithoutTextureTheMapIsEmptyAndThatIsSaid) {
  const std::string black = picture("black.png", GrayImage(120, 80)), map = temp_.file("d.png");
  const Outcome outcome = depth({black, black, "-o", map, "--colour", temp_.file("v.png")});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("level 0 in every pixel"));
  EXPECT_EQ(io::read_disparity(map), sensing::FloatImage(120, 80));

  GrayImage stripes(240, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 240; ++x) stripes.at(x, y) = x % 8 < 4 ? 220 : 30;
  }
  GrayImage shifted = stripes;
  for (std::uint8_t& level : shifted.pixels) level = static_cast<std::uint8_t>(level + 3);
  const auto json = depth_json({picture("a.png", stripes), picture("b.png", shifted)});
  EXPECT_EQ(json["density"], 0);
  EXPECT_THAT(json["warnings"].dump(), HasSubstr("repeats"));
}

TEST_F(DepthCommand, OddPairsAreDoubted) {
  EXPECT_THAT(depth({right(), left()}).err, HasSubstr("look swapped"));
  EXPECT_THAT(depth({right(), left(), "--setting", "middlebury"}).err, HasSubstr("look swapped"));
  EXPECT_THAT(depth({left(), left()}).err, HasSubstr("the same"));
  EXPECT_THAT(depth({left(), right()}).err, Not(HasSubstr("warning")));
}

TEST_F(DepthCommand, OutputsThatCannotBeMeantAreRefused) {
  expect_one_line(depth({}), 2, {"left and right"});
  expect_one_line(depth({left()}), 2, {"left and right"});
  expect_one_line(depth({left(), right(), "-o", "d.jpg"}), 2, {"d.jpg", ".png", ".pfm"});
  expect_one_line(depth({left(), right(), "--colour", "v.pfm"}), 2, {"v.pfm", ".png"});
  expect_one_line(depth({left(), right(), "--mask", left()}), 2, {"--truth"});
  const std::string before = bytes_of(left());
  expect_one_line(depth({left(), right(), "-o", left()}), 2, {left(), "replace"});
  expect_one_line(
      depth({left(), right(), "-o", temp_.file("x.png"), "--colour", temp_.file("./x.png")}), 2,
      {"replace"});
  EXPECT_EQ(bytes_of(left()), before);
  expect_one_line(depth({left(), right(), "-o", temp_.file("no/where/d.png")}), 5, {"no/where"});
}

TEST_F(DepthCommand, IsMeasuredBesideItsPeers) {
  const auto json = partita_json(
      {"bench", "peers", "--task", "depth", "--rounds", "3", "--pair", left(), right()});
  const auto& row = json["measured"][0];
  EXPECT_EQ(row["task"], "depth");
  EXPECT_EQ(row["ours"]["rounds_ms"].size(), 3u);
  ASSERT_EQ(row["peers"].size(), 2u);
  for (const auto& peer : row["peers"]) {
    EXPECT_THAT(peer["name"], HasSubstr("StereoSGBM"));
    const double ours = row["ours"]["median_ms"], theirs = peer["median_ms"];
    EXPECT_DOUBLE_EQ(peer["ratio"], theirs / ours);
    EXPECT_FALSE(peer.contains("quality"));  // these files come without their truth
    EXPECT_THAT(peer["parameters"], Not(HasSubstr("\n")));
  }
}

/// The document's program is the one that is built here, and finds what the command finds.
TEST_F(DepthCommand, TheExampleInTheDocumentWorks) {
  const std::string docs = PARTITA_DOCS;
  EXPECT_THAT(bytes_of(docs + "/depth.md"),
              HasSubstr("```cpp\n" + bytes_of(docs + "/examples/depth.cpp") + "```\n"));
  const std::string out = temp_.file("out.txt");
  const std::string command =
      std::string(PARTITA_DEPTH_EXAMPLE) + " " + left() + " " + right() + " >" + out;
  ASSERT_EQ(std::system(command.c_str()), 0);
  const double density = depth_json({left(), right(), "--set", "lr_threshold=1"})["density"];
  char expected[80];
  std::snprintf(expected, sizeof(expected), "%.1f %% of the pixels have one\n", 100 * density);
  EXPECT_THAT(bytes_of(out), HasSubstr(expected));
}

}  // namespace
}  // namespace partita::testing
