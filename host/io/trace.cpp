#include "host/io/trace.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace partita::io {

namespace {

using Json = nlohmann::ordered_json;

/// The format counts microseconds; a double would lose nanoseconds after some hours.
std::string microseconds(std::int64_t ns) {
  const auto magnitude =
      ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
  return fmt::format("{}{}.{:03}", ns < 0 ? "-" : "", magnitude / 1000, magnitude % 1000);
}

}  // namespace

TraceWriter::TraceWriter(const std::string& path) : file_(path) {
  file_.write("{\"displayTimeUnit\":\"ns\",\"traceEvents\":[\n");
}

void TraceWriter::event(const Json& fields, std::string_view times) {
  std::string text = first_ ? "" : ",\n";
  text += fields.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.insert(text.size() - 1, times);
  first_ = false;
  file_.write(text);
}

int TraceWriter::process(std::string_view name) {
  const int id = ++processes_;
  event({{"ph", "M"}, {"pid", id}, {"name", "process_name"}, {"args", {{"name", name}}}}, "");
  event({{"ph", "M"}, {"pid", id}, {"name", "process_sort_index"}, {"args", {{"sort_index", id}}}},
        "");
  return id;
}

TraceWriter::Lane TraceWriter::lane(int process, std::string_view name) {
  const Lane lane{process, ++lanes_[process]};
  const Json base = {{"ph", "M"}, {"pid", lane.process}, {"tid", lane.lane}};
  Json named = base;
  named["name"] = "thread_name";
  named["args"] = {{"name", name}};
  event(named, "");
  Json sorted = base;
  sorted["name"] = "thread_sort_index";
  sorted["args"] = {{"sort_index", lane.lane}};
  event(sorted, "");
  return lane;
}

void TraceWriter::complete(Lane lane, std::string_view name, std::string_view category,
                           std::int64_t start_ns, std::int64_t duration_ns, const Json& args) {
  Json fields = {
      {"ph", "X"}, {"pid", lane.process}, {"tid", lane.lane}, {"name", name}, {"cat", category}};
  if (!args.empty()) fields["args"] = args;
  event(fields,
        fmt::format(",\"ts\":{},\"dur\":{}", microseconds(start_ns), microseconds(duration_ns)));
}

void TraceWriter::complete(Lane lane, std::string_view name, std::string_view category,
                           std::int64_t start_ns, std::int64_t duration_ns) {
  complete(lane, name, category, start_ns, duration_ns, Json::object());
}

void TraceWriter::counter(int process, std::string_view name, std::int64_t time_ns, double value) {
  event({{"ph", "C"}, {"pid", process}, {"name", name}, {"args", {{"value", value}}}},
        fmt::format(",\"ts\":{}", microseconds(time_ns)));
}

void TraceWriter::close() {
  file_.write("\n]}\n");
  file_.commit();
}

}  // namespace partita::io
