#include "host/app/run_counts.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/io/json_file.h"
#include "host/runtime/error.h"

namespace partita::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMost = std::int64_t{1} << 40;  ///< of any count: a Work stays in 64 bits

/// A mapping of the file; its place in errors is "out/work.json: frames[3].depth".
class Entry {
 public:
  Entry(const Json& json, std::string place) : json_(json), place_(std::move(place)) {
    if (!json.is_object()) fail("is no object");
  }

  Entry child(const char* key) const { return {member(key), fmt::format("{}.{}", place_, key)}; }
  std::vector<Entry> list(const char* key, std::size_t least, std::size_t most) const {
    const Json& items = member(key);
    if (!items.is_array() || items.size() < least || items.size() > most) {
      fail(fmt::format("{} is no list of {} to {}", key, least, most));
    }
    std::vector<Entry> entries;
    for (const Json& item : items) {
      entries.emplace_back(item, fmt::format("{}.{}[{}]", place_, key, entries.size()));
    }
    return entries;
  }
  template <typename T>
  void read(const char* key, T& to, std::int64_t least, std::int64_t most) const {
    const Json& value = member(key);
    if (!value.is_number_integer() || value.get<double>() < static_cast<double>(least) ||
        value.get<double>() > static_cast<double>(most)) {
      fail(fmt::format("{} is {}, expected a whole number in [{}, {}]", key,
                       value.dump().substr(0, 40), least, most));
    }
    to = value.get<T>();
  }
  void read(const char* key, bool& to) const {
    if (!member(key).is_boolean()) fail(fmt::format("{} is not true or false", key));
    to = member(key).get<bool>();
  }
  void read(const char* key, std::string& to) const {
    if (!member(key).is_string()) fail(fmt::format("{} is no text", key));
    to = member(key).get<std::string>();
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}: {}: not what a run writes; make it anew with `partita run`",
                            place_, what));
  }

 private:
  const Json& member(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(fmt::format("has no '{}'", key));
    return *found;
  }

  const Json& json_;
  std::string place_;
};

Json to_json(const frontend::FrameCounts& counts) {
  Json json{{"keypoints_left", counts.keypoints_left},
            {"keypoints_right", counts.keypoints_right},
            {"reference", counts.reference},
            {"searches", Json::array()}};
  for (const frontend::SearchCounts& search : counts.searches) {
    json["searches"].push_back({{"wide", search.wide},
                                {"searched", search.searched},
                                {"matches", search.matches},
                                {"hypotheses", search.hypotheses},
                                {"inliers", search.inliers},
                                {"iterations", search.iterations}});
  }
  return json;
}

Json to_json(const depth::FrameCounts& counts) {
  Json json{{"support_points", counts.support_points}};
  for (const depth::ViewCounts& view : counts.views) {
    json["views"].push_back({{"triangles", view.triangles},
                             {"spans", view.spans},
                             {"covered", view.covered},
                             {"overlaps", view.overlaps},
                             {"entries", view.entries}});
  }
  return json;
}

frontend::FrameCounts frontend_counts(const Entry& entry) {
  constexpr std::int64_t kFeatures = 4096, kSteps = 1'000'000;
  frontend::FrameCounts counts;
  entry.read("keypoints_left", counts.keypoints_left, 0, kFeatures);
  entry.read("keypoints_right", counts.keypoints_right, 0, kFeatures);
  entry.read("reference", counts.reference, 0, kFeatures);
  for (const Entry& from : entry.list("searches", 0, 2)) {
    frontend::SearchCounts search;
    from.read("wide", search.wide);
    from.read("searched", search.searched, 0, counts.reference);
    from.read("matches", search.matches, 0, search.searched);
    from.read("hypotheses", search.hypotheses, 0, kSteps);
    from.read("inliers", search.inliers, 0, search.matches);
    from.read("iterations", search.iterations, 0, kSteps);
    counts.searches.push_back(search);
  }
  return counts;
}

depth::FrameCounts depth_counts(const Entry& entry) {
  depth::FrameCounts counts;
  entry.read("support_points", counts.support_points, 0, kMost);
  for (std::size_t i = 0; const Entry& from : entry.list("views", 2, 2)) {
    depth::ViewCounts& view = counts.views[i++];
    from.read("triangles", view.triangles, 0, kMost);
    from.read("spans", view.spans, 0, kMost);
    from.read("covered", view.covered, 0, kMost);
    from.read("overlaps", view.overlaps, 0, kMost);
    from.read("entries", view.entries, 0, kMost);
  }
  return counts;
}

}  // namespace

void write_counts(const std::string& path, const RunCounts& counts) {
  Json json{{"tool", "partita"},
            {"origin", counts.origin},
            {"width", counts.width},
            {"height", counts.height},
            {"frames", Json::array()}};
  for (const FrameWork& frame : counts.frames) {
    json["frames"].push_back({{"frame", frame.frame},
                              {"frontend", to_json(frame.frontend)},
                              {"depth", to_json(frame.depth)}});
  }
  io::write_json(path, json);
}

RunCounts read_counts(const std::string& path) {
  const Json json = io::read_json(path);
  const Entry file(json, path);
  RunCounts counts;
  file.read("origin", counts.origin);
  file.read("width", counts.width, 64, 4096);
  file.read("height", counts.height, 64, 4096);
  for (const Entry& entry : file.list("frames", 1, 1'000'000)) {
    FrameWork frame;
    entry.read("frame", frame.frame, counts.frames.empty() ? 0 : counts.frames.back().frame + 1,
               kMost);
    frame.frontend = frontend_counts(entry.child("frontend"));
    frame.depth = depth_counts(entry.child("depth"));
    counts.frames.push_back(frame);
  }
  return counts;
}

}  // namespace partita::app
