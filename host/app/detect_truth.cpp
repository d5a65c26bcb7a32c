// The truth of pictures, from labels of KITTI or COCO, in the classes of a network.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "host/app/detect.h"
#include "host/io/labels.h"
#include "host/runtime/error.h"

namespace partita::app {
namespace {

namespace fs = std::filesystem;
using detection::Truth;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// The position of the first of `wanted` among the names.
std::optional<int> class_of(const std::vector<std::string>& names,
                            std::initializer_list<const char*> wanted) {
  for (const char* name : wanted) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const std::string& n) { return lower(n) == name; });
    if (found != names.end()) return static_cast<int>(found - names.begin());
  }
  return {};
}

detection::Box box_of(const io::LabelBox& b) {
  return {b.left, b.top, b.right, b.bottom};
}

struct Limits {
  double least_height = 0;  ///< px
  int most_occluded = 3;
  double most_truncated = 1;
};
Limits limits_of(Difficulty difficulty) {
  switch (difficulty) {
    case Difficulty::easy:
      return {40, 0, 0.15};
    case Difficulty::moderate:
      return {25, 1, 0.30};
    case Difficulty::hard:
      return {25, 2, 0.50};
    default:
      return {};
  }
}

/// What a KITTI label means to a network's classes.
class KittiClasses {
 public:
  explicit KittiClasses(const std::vector<std::string>& names)
      : person_(class_of(names, {"pedestrian", "person"})),
        own_{{"Car", class_of(names, {"car"})},
             {"Van", class_of(names, {"van"})},
             {"Truck", class_of(names, {"truck"})},
             {"Pedestrian", person_},
             {"Cyclist", class_of(names, {"cyclist"})},
             {"Tram", class_of(names, {"tram", "train"})}},
        near_{{"Van", class_of(names, {"car"})},
              {"Person_sitting", person_},
              {"Cyclist", class_of(names, {"person"})}} {}

  bool any() const {
    return std::any_of(own_.begin(), own_.end(), [](const auto& e) { return e.second; });
  }
  /// The class that it belongs to.
  std::optional<int> own(const std::string& type) const { return find(own_, type); }
  /// The class that it may be taken for.
  std::optional<int> near(const std::string& type) const { return find(near_, type); }

 private:
  using Classes = std::map<std::string, std::optional<int>>;
  static std::optional<int> find(const Classes& classes, const std::string& type) {
    const auto found = classes.find(type);
    return found == classes.end() ? std::nullopt : found->second;
  }
  std::optional<int> person_;
  Classes own_, near_;
};

Truth kitti_truth(const std::string& path, const KittiClasses& classes, const Limits& limits) {
  Truth truth;
  truth.least_height = limits.least_height;
  for (const io::KittiLabel& label : io::read_kitti_labels(path)) {
    const detection::Box box = box_of(label.box);
    if (label.type == "DontCare") {
      truth.regions.push_back({box});
    } else if (const auto own = classes.own(label.type)) {
      const bool hard = box.height() < limits.least_height ||
                        label.occluded > limits.most_occluded ||
                        label.truncated > limits.most_truncated;
      truth.objects.push_back({box, *own, hard});
    } else if (const auto near = classes.near(label.type)) {
      truth.objects.push_back({box, *near, true});
    }
  }
  return truth;
}

std::vector<Truth> read_kitti(const fs::path& folder, const std::vector<std::string>& pictures,
                              const std::vector<std::string>& names, Difficulty difficulty) {
  const KittiClasses classes(names);
  if (!classes.any()) {
    throw Error(
        fmt::format("{}: none of the network's classes is one of KITTI's, expected car, "
                    "pedestrian or cyclist among the names",
                    folder.string()));
  }
  const fs::path inner = folder / "label_2";
  const fs::path labels = fs::is_directory(inner) ? inner : folder;
  std::vector<Truth> truths;
  std::map<fs::path, std::string> pictures_of;
  for (const std::string& picture : pictures) {
    const fs::path file = labels / fs::path(picture).stem().concat(".txt");
    if (!fs::exists(file)) {
      throw Error(fmt::format("{}: no labels for '{}', expected '{}'", folder.string(), picture,
                              file.string()));
    }
    if (const auto [other, first] = pictures_of.emplace(file, picture); !first) {
      throw Error(fmt::format("{}: belongs to '{}' and to '{}', expected pictures of one data set",
                              file.string(), other->second, picture));
    }
    truths.push_back(kitti_truth(file.string(), classes, limits_of(difficulty)));
  }
  return truths;
}

/// The network's class of each of the file's categories.
std::vector<std::optional<int>> coco_classes(const io::CocoTruth& coco,
                                             const std::vector<std::string>& names) {
  std::vector<std::optional<int>> classes;
  for (const io::CocoCategory& category : coco.categories) {
    const auto same = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      const auto id = io::coco_category(lower(name));
      return lower(name) == lower(category.name) ||
             (id && id == io::coco_category(lower(category.name)));
    });
    classes.push_back(same == names.end()
                          ? std::nullopt
                          : std::optional<int>(static_cast<int>(same - names.begin())));
  }
  return classes;
}

std::vector<Truth> read_coco(const std::string& path, const std::vector<std::string>& pictures,
                             const std::vector<std::string>& names) {
  const io::CocoTruth coco = io::read_coco_truth(path);
  const std::vector<std::optional<int>> classes = coco_classes(coco, names);
  if (std::none_of(classes.begin(), classes.end(), [](const auto& c) { return c.has_value(); })) {
    throw Error(fmt::format("{}: none of the network's classes is one of its categories", path));
  }
  std::vector<Truth> of_image(coco.images.size());
  for (const io::CocoObject& object : coco.objects) {
    const std::optional<int> own = classes[object.category];
    if (!own) continue;
    if (object.crowd) {
      of_image[object.image].regions.push_back({box_of(object.box), own});
    } else {
      of_image[object.image].objects.push_back({box_of(object.box), *own, false});
    }
  }
  std::map<std::string, std::size_t> by_name;
  for (std::size_t i = 0; i < coco.images.size(); ++i) {
    by_name.emplace(fs::path(coco.images[i].file_name).filename().string(), i);
  }
  std::vector<Truth> truths;
  for (const std::string& picture : pictures) {
    const auto found = by_name.find(fs::path(picture).filename().string());
    if (found == by_name.end()) {
      throw Error(fmt::format("{}: no image with the file name of '{}'", path, picture));
    }
    truths.push_back(of_image[found->second]);
  }
  return truths;
}

}  // namespace

std::vector<Truth> read_truth(const std::string& path, const std::vector<std::string>& pictures,
                              const std::vector<std::string>& names, Difficulty difficulty) {
  if (fs::is_directory(path)) return read_kitti(path, pictures, names, difficulty);
  if (fs::path(path).extension() == ".json") return read_coco(path, pictures, names);
  throw Error(
      fmt::format("{}: no truth, expected a folder with KITTI's labels or COCO's "
                  "annotations (.json)",
                  path));
}

}  // namespace partita::app
