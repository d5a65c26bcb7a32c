// COCO's annotations in JSON.
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/io/json_file.h"
#include "host/io/labels.h"
#include "host/runtime/error.h"

namespace partita::io {

namespace {

using Json = nlohmann::ordered_json;

/// One entry of a list in the file, for reading its values and for saying where it is.
class Entry {
 public:
  Entry(const std::string& path, const char* list, std::size_t index, const Json& value)
      : where_(fmt::format("{}: {}[{}]", path, list, index)), value_(value) {
    if (!value.is_object()) throw Error(where_ + " is no object");
  }

  std::int64_t whole(const char* key) const {
    const Json& v = at(key, "a whole number");
    if (!v.is_number_integer()) fail(key, "a whole number");
    if (v.is_number_unsigned() &&
        v.get<std::uint64_t>() >
            static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      fail(key, "a whole number below 2^63");
    }
    return v.get<std::int64_t>();
  }
  std::string text(const char* key) const {
    const Json& v = at(key, "a text");
    if (!v.is_string()) fail(key, "a text");
    return v.get<std::string>();
  }
  /// [left, top, width, height]
  LabelBox box(const char* key) const {
    constexpr const char* kExpected = "four finite numbers: left, top, width, height";
    const Json& v = at(key, kExpected);
    if (!v.is_array() || v.size() != 4) fail(key, kExpected);
    for (const Json& number : v) {
      if (!number.is_number() || !(std::abs(number.get<double>()) <= 1e15)) fail(key, kExpected);
    }
    const double width = v[2].get<double>();
    const double height = v[3].get<double>();
    if (width < 0 || height < 0) fail(key, "a width and a height that are not negative");
    const double left = v[0].get<double>();
    const double top = v[1].get<double>();
    return {left, top, left + width, top + height};
  }
  bool has(const char* key) const { return value_.contains(key); }
  [[noreturn]] void fail(const char* key, const std::string& expected) const {
    throw Error(fmt::format("{}.{}: expected {}", where_, key, expected));
  }

 private:
  const Json& at(const char* key, const char* expected) const {
    const auto found = value_.find(key);
    if (found == value_.end()) fail(key, expected);
    return *found;
  }

  std::string where_;
  const Json& value_;
};

template <class Visit>
void each_entry(const std::string& path, const Json& document, const char* list, Visit visit) {
  if (!document.is_object() || !document.contains(list) || !document[list].is_array()) {
    throw Error(fmt::format("{}: no list '{}', expected COCO's images, annotations and categories",
                            path, list));
  }
  for (std::size_t i = 0; i < document[list].size(); ++i) {
    visit(Entry(path, list, i, document[list][i]));
  }
}

}  // namespace

CocoTruth read_coco_truth(const std::string& path) {
  const Json document = read_json(path);
  CocoTruth truth;
  std::unordered_map<std::int64_t, std::size_t> images;
  std::unordered_map<std::int64_t, std::size_t> categories;
  each_entry(path, document, "images", [&](const Entry& e) {
    if (!images.emplace(e.whole("id"), truth.images.size()).second) e.fail("id", "one of its own");
    truth.images.push_back({e.whole("id"), e.text("file_name")});
  });
  each_entry(path, document, "categories", [&](const Entry& e) {
    if (!categories.emplace(e.whole("id"), truth.categories.size()).second) {
      e.fail("id", "one of its own");
    }
    truth.categories.push_back({e.whole("id"), e.text("name")});
  });
  each_entry(path, document, "annotations", [&](const Entry& e) {
    const auto image = images.find(e.whole("image_id"));
    if (image == images.end()) e.fail("image_id", "the id of one of the images");
    const auto category = categories.find(e.whole("category_id"));
    if (category == categories.end()) e.fail("category_id", "the id of one of the categories");
    const bool crowd = e.has("iscrowd") && e.whole("iscrowd") != 0;
    truth.objects.push_back({image->second, category->second, e.box("bbox"), crowd});
  });
  return truth;
}

}  // namespace partita::io
