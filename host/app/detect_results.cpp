// What was found, as COCO's results, and how good it was.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/app/detect.h"
#include "host/io/labels.h"

namespace partita::app {
namespace {

double rounded(double value, double steps) {
  return std::round(value * steps) / steps;
}

std::vector<int> category_ids(const std::vector<std::string>& names) {
  std::vector<int> positions;
  std::vector<int> coco;
  for (const std::string& name : names) {
    positions.push_back(static_cast<int>(positions.size()));
    if (const auto id = io::coco_category(name)) coco.push_back(*id);
  }
  const bool all_coco = names.size() == 80 && coco.size() == names.size();
  return all_coco ? coco : positions;
}

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

}  // namespace

Json coco_results(const std::vector<DetectedPicture>& pictures,
                  const std::vector<std::string>& names) {
  const std::vector<int> ids = category_ids(names);
  Json list = Json::array();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    for (const detection::Detection& d : pictures[i].detections) {
      const auto c = static_cast<std::size_t>(d.object_class);
      Json item;
      item["image_id"] = i;
      item["category_id"] = ids[c];
      item["bbox"] = {rounded(d.box.left, 1e3), rounded(d.box.top, 1e3),
                      rounded(d.box.width(), 1e3), rounded(d.box.height(), 1e3)};
      item["score"] = rounded(d.score, 1e6);
      item["file_name"] = pictures[i].path;
      item["category_name"] = names[c];
      list.push_back(std::move(item));
    }
  }
  return list;
}

Json precision_json(const detection::Precision& precision, const std::vector<std::string>& names) {
  Json json;
  json["ap50"] = precision.ap50;
  json["ap75"] = precision.ap75;
  json["ap50_95"] = precision.ap50_95;
  json["classes"] = Json::array();
  for (std::size_t c = 0; c < names.size(); ++c) {
    const detection::ClassPrecision& own = precision.classes[c];
    if (own.objects == 0) continue;
    json["classes"].push_back({{"name", names[c]},
                               {"objects", own.objects},
                               {"ap50", own.ap50()},
                               {"ap50_95", own.ap50_95()},
                               {"recall50", own.recall50}});
  }
  return json;
}

Table precision_table(const detection::Precision& precision,
                      const std::vector<std::string>& names) {
  Table table({"class", "objects", "AP50", "AP50:95", "recall"});
  std::size_t objects = 0;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const detection::ClassPrecision& own = precision.classes[c];
    if (own.objects == 0) continue;
    objects += own.objects;
    table.add({names[c], std::to_string(own.objects), percent(own.ap50()), percent(own.ap50_95()),
               percent(own.recall50)});
  }
  table.add(
      {"mean", std::to_string(objects), percent(precision.ap50), percent(precision.ap50_95), ""});
  return table;
}

}  // namespace partita::app
