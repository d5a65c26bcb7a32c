// Labels of KITTI and COCO, names of classes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/io/labels.h"
#include "tests/host/io_temp_folder.h"

namespace partita::io {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::TempFolder;

TEST(KittiLabels, AreReadAsTheyAreWritten) {
  const TempFolder folder;
  const auto labels = read_kitti_labels(folder.write(
      "a.txt",
      "Car 0.88 2 -0.69 0.00 192.37 402.31 374.00 1.60 1.57 3.23 -2.70 1.74 3.68 -1.29\n"
      "DontCare -1 -1 -10 800.38 163.67 825.45 184.07 -1 -1 -1 -1000 -1000 -1000 -10\n"));
  ASSERT_EQ(labels.size(), 2U);
  EXPECT_EQ(labels[0].type, "Car");
  EXPECT_DOUBLE_EQ(labels[0].truncated, 0.88);
  EXPECT_EQ(labels[0].occluded, 2);
  EXPECT_DOUBLE_EQ(labels[0].box.top, 192.37);
  EXPECT_DOUBLE_EQ(labels[1].box.right, 825.45);
  EXPECT_TRUE(read_kitti_labels(folder.write("none.txt", "")).empty());
}

TEST(KittiLabels, SayWhatIsWrongAndWhere) {
  const TempFolder folder;
  const std::string good = "Car 0 0 -10 1 2 3 4 -1 -1 -1 -1000 -1000 10 -10\n";
  const auto message = [&](const std::string& line) {
    const std::string path = folder.write("a.txt", good + line + "\n");
    return error_of([&] { read_kitti_labels(path); });
  };
  EXPECT_THAT(message("Car 0 0"), HasSubstr("a.txt:2: 3 fields, expected the 15"));
  EXPECT_THAT(message("Cat 0 0 -10 1 2 3 4 -1 -1 -1 -1000 -1000 10 -10"),
              HasSubstr("expected one of Car, Van"));
  EXPECT_THAT(message("Car 0 0 -10 1 nan 3 4 -1 -1 -1 -1000 -1000 10 -10"), HasSubstr("'nan'"));
  EXPECT_THAT(message("Car 0 0 -10 3 2 3 4 -1 -1 -1 -1000 -1000 10 -10"), HasSubstr("empty box"));
  EXPECT_THAT(message("Car 2 0 -10 1 2 3 4 -1 -1 -1 -1000 -1000 10 -10"), HasSubstr("truncated"));
  EXPECT_THAT(message("Car 0 1.5 -10 1 2 3 4 -1 -1 -1 -1000 -1000 10 -10"), HasSubstr("occluded"));
}

constexpr const char* kCoco =
    R"({"images": [{"id": 7, "file_name": "a.jpg"}, {"id": 9, "file_name": "b.jpg"}],
        "categories": [{"id": 3, "name": "car"}],
        "annotations": [{"image_id": 9, "category_id": 3, "bbox": [1.5, 2, 3, 4], "iscrowd": 1},
                        {"image_id": 7, "category_id": 3, "bbox": [0, 0, 5, 5]}]})";

TEST(CocoTruth, IsReadAsItIsWritten) {
  const TempFolder folder;
  const CocoTruth truth = read_coco_truth(folder.write("a.json", kCoco));
  ASSERT_EQ(truth.objects.size(), 2U);
  EXPECT_EQ(truth.images[truth.objects[0].image].file_name, "b.jpg");
  EXPECT_TRUE(truth.objects[0].crowd);
  EXPECT_FALSE(truth.objects[1].crowd);
  EXPECT_DOUBLE_EQ(truth.objects[0].box.right, 4.5);
  EXPECT_DOUBLE_EQ(truth.objects[0].box.bottom, 6);
}

TEST(CocoTruth, SaysWhatIsWrongAndWhere) {
  const TempFolder folder;
  const auto message = [&](const std::string& from, const std::string& to) {
    std::string text = kCoco;
    text.replace(text.find(from), from.size(), to);
    const std::string path = folder.write("a.json", text);
    return error_of([&] { read_coco_truth(path); });
  };
  EXPECT_THAT(message("[1.5, 2, 3, 4]", "[1.5, 2, 3]"), HasSubstr("annotations[0].bbox"));
  EXPECT_THAT(message("[1.5, 2, 3, 4]", "[1.5, 2, -3, 4]"), HasSubstr("not negative"));
  EXPECT_THAT(message("\"image_id\": 7", "\"image_id\": 8"), HasSubstr("annotations[1].image_id"));
  EXPECT_THAT(message("\"name\": \"car\"", "\"name\": 3"), HasSubstr("categories[0].name"));
  EXPECT_THAT(message("\"id\": 9", "\"id\": 7"), HasSubstr("images[1].id"));
  EXPECT_THAT(message("\"images\"", "\"pictures\""), HasSubstr("no list 'images'"));
}

TEST(Names, AreOneForEachLine) {
  const TempFolder folder;
  EXPECT_EQ(read_names(folder.write("a.names", "car\r\nfire hydrant\n\ndog")),
            (std::vector<std::string>{"car", "fire hydrant", "dog"}));
  EXPECT_THAT(error_of([&] { read_names(folder.write("b.names", "\n")); }), HasSubstr("no names"));
}

TEST(Names, OfCocoHaveItsIds) {
  EXPECT_EQ(coco_category("person"), 1);
  EXPECT_EQ(coco_category("toothbrush"), 90);
  EXPECT_EQ(coco_category("sofa"), coco_category("couch"));  // Darknet's older name
  EXPECT_EQ(coco_category("pedestrian"), std::nullopt);
}

}  // namespace
}  // namespace partita::io
