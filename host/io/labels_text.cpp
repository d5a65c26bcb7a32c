// Labels and names in text files.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "host/io/file.h"
#include "host/io/labels.h"
#include "host/io/text.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

constexpr std::array<std::string_view, 9> kTypes = {
    "Car", "Van", "Truck", "Pedestrian", "Person_sitting", "Cyclist", "Tram", "Misc", "DontCare"};

// In the order of their ids, which have gaps.
struct Category {
  int id;
  std::string_view name;
};
constexpr std::array<Category, 80> kCoco = {{
    {1, "person"},         {2, "bicycle"},       {3, "car"},
    {4, "motorcycle"},     {5, "airplane"},      {6, "bus"},
    {7, "train"},          {8, "truck"},         {9, "boat"},
    {10, "traffic light"}, {11, "fire hydrant"}, {13, "stop sign"},
    {14, "parking meter"}, {15, "bench"},        {16, "bird"},
    {17, "cat"},           {18, "dog"},          {19, "horse"},
    {20, "sheep"},         {21, "cow"},          {22, "elephant"},
    {23, "bear"},          {24, "zebra"},        {25, "giraffe"},
    {27, "backpack"},      {28, "umbrella"},     {31, "handbag"},
    {32, "tie"},           {33, "suitcase"},     {34, "frisbee"},
    {35, "skis"},          {36, "snowboard"},    {37, "sports ball"},
    {38, "kite"},          {39, "baseball bat"}, {40, "baseball glove"},
    {41, "skateboard"},    {42, "surfboard"},    {43, "tennis racket"},
    {44, "bottle"},        {46, "wine glass"},   {47, "cup"},
    {48, "fork"},          {49, "knife"},        {50, "spoon"},
    {51, "bowl"},          {52, "banana"},       {53, "apple"},
    {54, "sandwich"},      {55, "orange"},       {56, "broccoli"},
    {57, "carrot"},        {58, "hot dog"},      {59, "pizza"},
    {60, "donut"},         {61, "cake"},         {62, "chair"},
    {63, "couch"},         {64, "potted plant"}, {65, "bed"},
    {67, "dining table"},  {70, "toilet"},       {72, "tv"},
    {73, "laptop"},        {74, "mouse"},        {75, "remote"},
    {76, "keyboard"},      {77, "cell phone"},   {78, "microwave"},
    {79, "oven"},          {80, "toaster"},      {81, "sink"},
    {82, "refrigerator"},  {84, "book"},         {85, "clock"},
    {86, "vase"},          {87, "scissors"},     {88, "teddy bear"},
    {89, "hair drier"},    {90, "toothbrush"},
}};

// Darknet's older lists call some classes otherwise.
constexpr std::array<std::array<std::string_view, 2>, 6> kOlderNames = {
    {{"motorbike", "motorcycle"},
     {"aeroplane", "airplane"},
     {"sofa", "couch"},
     {"pottedplant", "potted plant"},
     {"diningtable", "dining table"},
     {"tvmonitor", "tv"}}};

}  // namespace

std::vector<KittiLabel> read_kitti_labels(const std::string& path) {
  const TextFile file(path);
  std::vector<KittiLabel> labels;
  for (const TextRow& row : file.rows()) {
    if (row.words.size() != 15 && row.words.size() != 16) {
      file.fail(row, fmt::format("{} fields, expected the 15 of a KITTI label: type truncated "
                                 "occluded alpha left top right bottom height width length x y z "
                                 "rotation_y",
                                 row.words.size()));
    }
    if (std::find(kTypes.begin(), kTypes.end(), row.words[0]) == kTypes.end()) {
      file.fail(row, fmt::format("no type of KITTI's, expected one of {}",
                                 "Car, Van, Truck, Pedestrian, Person_sitting, Cyclist, Tram, "
                                 "Misc, DontCare"));
    }
    for (std::size_t i = 1; i < row.words.size(); ++i) file.number(row, i);
    KittiLabel label{.type = std::string(row.words[0]), .box = {}};
    label.truncated = file.number(row, 1);
    const double occluded = file.number(row, 2);
    if (label.truncated < -1 || label.truncated > 1) {
      file.fail(row, "truncated is expected between 0 and 1, or -1");
    }
    if (occluded != std::floor(occluded) || occluded < -1 || occluded > 3) {
      file.fail(row, "occluded is expected to be 0, 1, 2 or 3, or -1");
    }
    label.occluded = static_cast<int>(occluded);
    label.box = {file.number(row, 4), file.number(row, 5), file.number(row, 6),
                 file.number(row, 7)};
    if (!(label.box.right > label.box.left && label.box.bottom > label.box.top)) {
      file.fail(row, "an empty box, expected left < right and top < bottom");
    }
    labels.push_back(std::move(label));
  }
  return labels;
}

std::vector<std::string> read_names(const std::string& path) {
  const std::string text = read_file(path);
  if (text.find('\0') != text.npos) throw Error(fmt::format("{}: not a text file", path));
  std::vector<std::string> names;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = std::string_view(text).substr(at, end - at);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (!line.empty()) names.emplace_back(line);
    at = end + 1;
  }
  if (names.empty()) throw Error(fmt::format("{}: no names, expected one for each line", path));
  return names;
}

std::optional<int> coco_category(const std::string& name) {
  std::string_view wanted = name;
  for (const auto& [older, today] : kOlderNames) {
    if (name == older) wanted = today;
  }
  const auto found =
      std::find_if(kCoco.begin(), kCoco.end(), [&](const Category& c) { return c.name == wanted; });
  if (found == kCoco.end()) return {};
  return found->id;
}

}  // namespace partita::io
