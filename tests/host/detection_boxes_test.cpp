// The host's steps of detection: fitting, decoding, suppression; average precision against cases
// that were computed by hand.
#include <cmath>
#include <random>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "host/tasks/detection/curves.h"
#include "host/tasks/detection/evaluation.h"
#include "host/tasks/detection/letterbox.h"
#include "host/tasks/detection/nms.h"

namespace partita::detection {
namespace {

sensing::ColourImage noise(int width, int height) {
  sensing::ColourImage picture(width, height);
  std::mt19937 random(7);
  for (sensing::Rgb& p : picture.pixels) {
    const std::uint32_t bits = random();
    p = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
         static_cast<std::uint8_t>(bits >> 16)};
  }
  return picture;
}

TEST(Fit, PlacesPicturesAsDarknetDoes) {
  const Placed wide = place(1280, 720, 416, 416, Fit::letterbox);
  EXPECT_EQ(wide.width, 416);
  EXPECT_EQ(wide.height, 234);
  EXPECT_EQ(wide.left, 0);
  EXPECT_EQ(wide.top, 91);
  const Placed tall = place(3, 4000, 320, 320, Fit::letterbox);
  EXPECT_EQ(tall.width, 1);  // never nothing
  EXPECT_EQ(tall.height, 320);
  const Placed stretched = place(1280, 720, 416, 416, Fit::stretch);
  EXPECT_EQ(stretched.width, 416);
  EXPECT_EQ(stretched.height, 416);
  EXPECT_EQ(stretched.top, 0);
}

TEST(Fit, ResizesAsOpenCvDoes) {
  constexpr std::pair<int, int> kSizes[] = {{1280, 720}, {37, 91},   {1, 1},      {320, 320},
                                            {2, 500},    {640, 448}, {1920, 1080}};
  for (const auto& [width, height] : kSizes) {
    sensing::ColourImage picture = noise(width, height);
    const cv::Mat mat(height, width, CV_8UC3, picture.pixels.data());
    cv::Mat expected;
    cv::resize(mat, expected, {320, 224}, 0, 0, cv::INTER_LINEAR);
    std::vector<float> got;
    fit_picture(picture, place(width, height, 320, 224, Fit::stretch), got);
    ASSERT_EQ(got.size(), expected.total() * 3);
    std::size_t different = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      ASSERT_NEAR(got[i] * 255, expected.data[i], 1.001) << width << "x" << height << " at " << i;
      different += std::abs(got[i] * 255 - static_cast<float>(expected.data[i])) > 0.5F ? 1 : 0;
    }
    EXPECT_LE(different, got.size() / 300) << width << "x" << height;
  }
}

TEST(Fit, BarsAreGrayAndThePictureLiesBetween) {
  sensing::ColourImage white(40, 10, {255, 255, 255});
  std::vector<float> got;
  fit_picture(white, place(40, 10, 32, 32, Fit::letterbox), got);
  for (int y = 0; y < 32; ++y) {
    for (int i = 0; i < 96; ++i) {
      ASSERT_EQ(got[static_cast<std::size_t>(y * 96 + i)], y >= 12 && y < 20 ? 1.0F : 0.5F);
    }
  }
}

TEST(Curves, AreCloseToTheTrueOnes) {
  for (float x = -80; x <= 80; x += 0.37F) {
    EXPECT_NEAR(exp_80(x) / std::exp(static_cast<double>(x)), 1, 1e-6) << x;
    EXPECT_NEAR(logistic(x) * (1 + std::exp(-static_cast<double>(x))), 1, 1e-6) << x;
  }
  EXPECT_EQ(logistic(0), 0.5F);
  EXPECT_GE(logistic(-1e30F), 0);
  EXPECT_FLOAT_EQ(logistic(1e30F), 1);
}

/// A network of one yolo layer of 2 x 2 cells, two anchors of which one is used, two classes.
struct OneScale {
  OneScale() {
    model.input = {64, 32, 3};
    model.layers.resize(1);
    io::darknet::Yolo& yolo = model.layers[0].yolo;
    yolo.anchors = {{1, 1}, {8, 16}};
    yolo.mask = {1};
    yolo.classes = 2;
    yolo.scale_x_y = 1.5F;
    output = {.layer = 0, .width = 2, .height = 2, .channels = 7, .values = {}};
    output.values.assign(28, -20.0F);
  }
  float* cell(int x, int y) { return &output.values[static_cast<std::size_t>((y * 2 + x) * 7)]; }

  io::darknet::Model model;
  RawOutput output;
};

TEST(Decode, GivesTheBoxThatTheNumbersMean) {
  OneScale scale;
  const float t[] = {0, 0, std::log(2.0F), 0, 3, -1, 2};
  std::copy(std::begin(t), std::end(t), scale.cell(1, 0));
  const auto found =
      decode(scale.model, {scale.output}, place(128, 64, 64, 32, Fit::stretch), 0.5F);
  ASSERT_EQ(found.size(), 1U);
  // Centre of the cell: (1.5, 0.5) of 2 x 2, so 96, 16 in the picture; 16 x 16 px of the input.
  EXPECT_NEAR(found[0].box.left, 96 - 16, 1e-4);
  EXPECT_NEAR(found[0].box.right, 96 + 16, 1e-4);
  EXPECT_NEAR(found[0].box.top, 16 - 16, 1e-4);
  EXPECT_NEAR(found[0].box.bottom, 16 + 16, 1e-4);
  EXPECT_EQ(found[0].object_class, 1);
  EXPECT_NEAR(found[0].score, 1 / (1 + std::exp(-3.0)) / (1 + std::exp(-2.0)), 1e-6);

  scale.cell(1, 0)[0] = 20;  // l = 1: the right edge of what scale_x_y = 1.5 reaches
  const Placed letterbox = place(64, 64, 64, 32, Fit::letterbox);  // 32 x 32, 16 px from the left
  const auto moved = decode(scale.model, {scale.output}, letterbox, 0.5F);
  EXPECT_NEAR(0.5 * (moved[0].box.left + moved[0].box.right), (32 * 2.25 - 16) * 2, 1e-3);
}

TEST(Decode, TakesNothingFromNumbersThatAreNone) {
  OneScale scale;
  for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
    for (int i = 0; i < 7; ++i) {
      const float t[] = {0, 0, 0, 0, 3, -1, 2};
      std::copy(std::begin(t), std::end(t), scale.cell(0, 1));
      scale.cell(0, 1)[i] = bad;
      EXPECT_TRUE(
          decode(scale.model, {scale.output}, place(64, 32, 64, 32, Fit::stretch), 0.1F).empty());
    }
  }
}

Detection detection_at(double left, float score, int object_class = 0) {
  return {{left, 0, left + 10, 10}, object_class, score};
}

TEST(Suppress, KeepsTheBestOfEachClass) {
  const Suppressed result = suppress({detection_at(0, 0.6F), detection_at(1, 0.9F),
                                      detection_at(1, 0.5F, 1), detection_at(40, 0.3F)},
                                     0.45);
  ASSERT_EQ(result.kept.size(), 3U);
  EXPECT_EQ(result.kept[0].score, 0.9F);
  EXPECT_EQ(result.kept[1].object_class, 1);
  EXPECT_EQ(result.kept[2].box.left, 40);
  EXPECT_EQ(result.compared, 2U);
}

TEST(Suppress, OfEqualScoresTheEarlierStaysAndTheLimitItselfIsAllowed) {
  // IoU of boxes of width 10, 5 apart: 50 / 150.
  EXPECT_EQ(suppress({detection_at(5, 0.5F), detection_at(0, 0.5F)}, 50.0 / 150).kept.size(), 2U);
  const Suppressed result = suppress({detection_at(5, 0.5F), detection_at(0, 0.5F)}, 0.33);
  ASSERT_EQ(result.kept.size(), 1U);
  EXPECT_EQ(result.kept[0].box.left, 5);
}

Truth truth_of(std::vector<TruthObject> objects) {
  return {.objects = std::move(objects), .regions = {}};
}
TruthObject object_at(double left, int object_class = 0, bool ignored = false) {
  return {{left, 0, left + 10, 10}, object_class, ignored};
}

TEST(AveragePrecision, OfAllFoundIsOne) {
  const Precision p = evaluate({{detection_at(0, 0.9F)}}, {truth_of({object_at(0)})}, 2);
  EXPECT_DOUBLE_EQ(p.ap50, 1);
  EXPECT_DOUBLE_EQ(p.ap50_95, 1);
  EXPECT_EQ(p.classes_with_objects, 1U);  // the other class has no object and no say
}

TEST(AveragePrecision, IsTheEnvelopeAtHundredAndOneRecalls) {
  // By falling score: right, wrong, right; three objects. Precision 1, 1/2, 2/3 at recall 1/3, 1/3,
  // 2/3. Recalls 0.00 to 0.33 (34 of them) have precision 1, 0.34 to 0.66 (33) 2/3, the rest none.
  const Precision p =
      evaluate({{detection_at(0, 0.9F), detection_at(500, 0.8F), detection_at(100, 0.7F)}},
               {truth_of({object_at(0), object_at(100), object_at(200)})}, 1);
  EXPECT_NEAR(p.ap50, (34 + 33 * 2.0 / 3) / 101, 1e-12);
  EXPECT_NEAR(p.classes[0].recall50, 2.0 / 3, 1e-12);
}

TEST(AveragePrecision, FallsWithTheOverlapThatIsAskedFor) {
  // 2 px off: IoU 80 / 120, so right at 0.50, 0.55, 0.60, 0.65 and wrong from 0.70 on.
  const Precision p = evaluate({{detection_at(2, 0.9F)}}, {truth_of({object_at(0)})}, 1);
  EXPECT_DOUBLE_EQ(p.ap50, 1);
  EXPECT_DOUBLE_EQ(p.ap75, 0);
  EXPECT_NEAR(p.ap50_95, 0.4, 1e-12);
}

TEST(AveragePrecision, CountsASecondDetectionOfAnObjectAsWrong) {
  const Precision p = evaluate({{detection_at(0, 0.9F), detection_at(1, 0.8F)}, {}},
                               {truth_of({object_at(0)}), truth_of({object_at(0)})}, 1);
  EXPECT_NEAR(p.ap50, 51.0 / 101, 1e-12);  // recall 0.5 at precision 1, then no more
}

TEST(AveragePrecision, IgnoresWhatIsTooHardAndWhatLiesInRegions) {
  Truth truth = truth_of({object_at(0), object_at(100, 0, true)});
  truth.regions = {{{200, 0, 300, 100}}, {{400, 0, 500, 100}, 1}};
  truth.least_height = 5;
  std::vector<Detection> found{detection_at(100, 0.95F), detection_at(200, 0.94F),
                               detection_at(210, 0.93F), detection_at(0, 0.5F)};
  EXPECT_DOUBLE_EQ(evaluate({found}, {truth}, 1).ap50, 1);
  found.push_back({{600, 0, 603, 4}, 0, 0.92F});  // too low to be asked for
  EXPECT_DOUBLE_EQ(evaluate({found}, {truth}, 1).ap50, 1);
  found.push_back(detection_at(400, 0.91F));  // a region of another class
  EXPECT_NEAR(evaluate({found}, {truth}, 1).ap50, 0.5, 1e-12);
}

TEST(AveragePrecision, PrefersAnObjectThatCountsToAnIgnoredOneThatFitsBetter) {
  const Precision p =
      evaluate({{detection_at(0, 0.9F)}}, {truth_of({object_at(0, 0, true), object_at(2)})}, 1);
  EXPECT_DOUBLE_EQ(p.ap50, 1);
}

TEST(AveragePrecision, TakesNoMoreThanAHundredDetectionsOfAPicture) {
  std::vector<Detection> found;
  for (int i = 0; i < 100; ++i) found.push_back(detection_at(1000 + 20 * i, 0.9F));
  found.push_back(detection_at(0, 0.1F));
  EXPECT_EQ(evaluate({found}, {truth_of({object_at(0)})}, 1).ap50, 0);
  found.erase(found.begin());
  EXPECT_NEAR(evaluate({found}, {truth_of({object_at(0)})}, 1).ap50, 0.01, 1e-12);
}

}  // namespace
}  // namespace partita::detection
