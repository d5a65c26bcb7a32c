// partita detect as a user calls it, with the detector that comes along.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/spawn.h"
#include "tests/host/io_temp_folder.h"

namespace partita::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kStreet = PARTITA_SOURCE_PROFILES "/detectors/street/street";

/// Four frames of a street that the detector was not trained on, two seconds apart.
class DetectCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    const Outcome made = partita({"generate", "--out", folder_->file("street"), "--frames", "4",
                                  "--rate", "1", "--seed", "2", "--quiet"});
    ASSERT_EQ(made.status, 0) << made.err;
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string picture(int i) {
    return folder_->file("street/image_0/00000" + std::to_string(i) + ".png");
  }
  static std::vector<std::string> words(std::vector<std::string> more) {
    std::vector<std::string> all{"detect", "--model", kStreet + ".cfg", "--weights",
                                 kStreet + ".weights"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  static std::vector<std::string> all_pictures(std::vector<std::string> more) {
    for (int i = 0; i < 4; ++i) more.push_back(picture(i));
    return words(more);
  }

  static inline TempFolder* folder_ = nullptr;
  TempFolder temp_;
};

TEST_F(DetectCommand, FindsTheStreetsRoadUsers) {
  const std::string out = temp_.file("detections.json");
  const nlohmann::json document = partita_json(
      all_pictures({"--truth", folder_->file("street"), "-o", out, "--draw", temp_.file("boxes")}));
  EXPECT_GE(document["precision"]["ap50"].get<double>(), 0.7);  // of four frames only
  EXPECT_EQ(document["precision"]["classes"].size(), 3U);
  const auto results = nlohmann::json::parse(bytes_of(out));
  EXPECT_EQ(results, document["detections"]);
  ASSERT_GT(results.size(), 8U);
  for (const auto& item : results) {
    const int image = item["image_id"];
    EXPECT_EQ(item["file_name"], picture(image));
    EXPECT_GT(item["score"], 0.25);
    EXPECT_EQ(item["bbox"].size(), 4U);
    EXPECT_THAT((std::vector<std::string>{"car", "pedestrian", "cyclist"}),
                ::testing::Contains(item["category_name"].get<std::string>()));
  }
  EXPECT_TRUE(fs::exists(temp_.file("boxes/0003_000003.png")));
  EXPECT_FALSE(fs::exists(temp_.file("boxes/PARTIAL")));
}

TEST_F(DetectCommand, ThresholdAndOverlapChooseAmongTheSameBoxes) {
  const auto all = partita_json(words({picture(0), "--threshold", "0.1"}))["detections"];
  const auto few = partita_json(words({picture(0), "--threshold", "0.5"}))["detections"];
  EXPECT_LT(few.size(), all.size());
  for (const auto& item : few) EXPECT_THAT(all, ::testing::Contains(item));
  const auto doubled =
      partita_json(words({picture(0), "--threshold", "0.1", "--nms", "1"}))["detections"];
  EXPECT_GT(doubled.size(), all.size());
}

TEST_F(DetectCommand, GivesTheSameBoxesOnAnEmulatedDevice) {
  const auto native = partita_json(words({picture(1)}))["detections"];
  const auto gpu =
      partita_json(words({picture(1), "--machine", "gpu-only", "--device", "gpu"}))["detections"];
  EXPECT_EQ(native, gpu);
}

TEST_F(DetectCommand, NamesWhatIsWrong) {
  const auto refused = [&](const std::vector<std::string>& arguments, int status,
                           const std::vector<std::string>& parts) {
    expect_one_line(partita(arguments), status, parts);
  };
  const std::string out = temp_.file("out.json");
  const std::string text = temp_.write("notes.png", "no picture");
  refused(words({picture(0), text, "-o", out}), 3, {"notes.png", "not a PNG, JPEG or PGM picture"});
  EXPECT_FALSE(fs::exists(out));
  refused(words({temp_.file("none.png")}), 3, {"none.png"});
  refused(words({temp_.write("empty.pgm", "P5 0 4 255\n")}), 3, {"empty.pgm", "impossible size"});
  refused(words({picture(0), "--names", temp_.write("two.names", "a\nb\n")}), 3,
          {"two.names", "2 names", "3 classes"});
  refused(words({picture(0), "--truth", temp_.path()}), 3, {"no labels", "000000.txt"});
  refused(words({picture(0), picture(0), "--truth", folder_->file("street")}), 3,
          {"000000.txt: belongs to", "pictures of one data set"});
  refused(words({picture(0), "--truth", text}), 3, {"notes.png", "no truth"});
  refused(words({picture(0), "--threshold", "nan"}), 2, {"--threshold"});
  refused(words({picture(0), "--nms", "2"}), 2, {"--nms"});
  refused(words({picture(0), "--fit", "crop"}), 2, {"--fit"});
  refused(words({picture(0), "-o", temp_.file("no/such/folder/out.json")}), 5, {"out.json"});
  refused({"detect", "--model", text, "--weights", kStreet + ".weights", picture(0)}, 3,
          {"notes.png"});
  refused({"detect", "--model", kStreet + ".cfg", "--weights", text, picture(0)}, 3, {"notes.png"});
  refused({"detect", "--model", kStreet + ".cfg", picture(0)}, 2, {"--weights"});
}

}  // namespace
}  // namespace partita::testing
