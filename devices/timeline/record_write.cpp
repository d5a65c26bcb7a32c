// The record's file: one JSON object per line. Written by hand, since a record may have millions of
// lines; read by record_read.cpp, which says what each line holds.
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <ostream>

#include <nlohmann/json.hpp>

#include "devices/timeline/record.h"

namespace partita::timeline {
namespace {

constexpr std::size_t kActionsPerLine = 256;

/// Appends JSON to a buffer; commas are set where a value follows a value.
class Line {
 public:
  Line& open(const char* bracket) { return item().raw(bracket, true); }
  Line& close(const char* bracket) {
    text_ += bracket;
    comma_ = true;
    return *this;
  }
  Line& key(const char* name) {
    item();
    text_ += '"';
    text_ += name;
    return raw("\":", true);
  }
  Line& number(std::uint64_t value) {
    item();
    char digits[24];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    return *this;
  }
  Line& number(std::int64_t value) {
    item();
    text_ += std::to_string(value);
    return *this;
  }
  Line& number(std::uint32_t value) { return number(std::uint64_t{value}); }
  Line& flag(bool value) { return item().raw(value ? "true" : "false", false); }
  Line& text(const std::string& value) {
    using nlohmann::json;
    return item().raw(json(value).dump(-1, ' ', true, json::error_handler_t::replace).c_str(),
                      false);
  }
  /// An id, or null for kNone.
  Line& id(std::uint32_t value) {
    return value == kNone ? item().raw("null", false) : number(value);
  }
  void end(std::ostream& out) {
    text_ += '\n';
    out << text_;
    text_.clear();
    comma_ = false;
  }

 private:
  Line& item() {
    if (comma_) text_ += ',';
    comma_ = true;
    return *this;
  }
  Line& raw(const char* more, bool opens) {
    text_ += more;
    if (opens) comma_ = false;
    return *this;
  }
  std::string text_;
  bool comma_ = false;
};

void write_layout(const Layout& layout, std::ostream& out) {
  Line line;
  for (const auto& n : layout.nodes) {
    line.open("{").key("node").open("{").key("name").text(n.name).key("cores").number(n.cores);
    line.key("memory_bps").number(n.memory_bps).key("unit_memory_bps").number(n.unit_memory_bps);
    line.key("api_call_ns").number(n.api_call_ns).key("wakeup_ns").number(n.wakeup_ns);
    line.close("}").close("}").end(out);
  }
  for (const auto& d : layout.devices) {
    line.open("{").key("device").open("{").key("name").text(d.name);
    line.key("type").text(std::string(profile::to_string(d.type))).key("node").number(d.node);
    line.key("is_host_cpu").flag(d.is_host_cpu).key("shared_memory").flag(d.shared_memory);
    line.key("memory_bps").number(d.memory_bps).key("link_bps").number(d.link_bps);
    line.key("link_latency_ns").number(d.link_latency_ns);
    line.key("api_call_ns").number(d.api_call_ns).key("submit_ns").number(d.submit_ns);
    line.key("wakeup_ns").number(d.wakeup_ns).close("}").close("}").end(out);
  }
  for (const auto& l : layout.links) {
    line.open("{").key("link").open("{").key("name").text(l.name).key("a").number(l.a);
    line.key("b").number(l.b).key("bps").number(l.bps).key("latency_ns").number(l.latency_ns);
    line.close("}").close("}").end(out);
  }
}

void write_work(const Work& w, std::ostream& out) {
  Line line;
  line.open("{").key("work").open("{");
  line.key("kind").text(std::string(model::to_string(w.kind))).key("ops").open("[");
  for (const std::uint64_t ops : w.ops) line.number(ops);
  line.close("]").key("bytes").open("[").number(w.read_issued).number(w.written_issued);
  line.number(w.read_unique).number(w.written_unique).number(w.local_bytes).close("]");
  line.key("estimated").flag(w.estimated != 0).key("loops").open("[");
  for (std::uint32_t i = 0; i < w.loop_count && i < kMaxWorkLoops; ++i) {
    const WorkLoop& loop = w.loops[i];
    line.open("[").number(loop.trips).number(loop.ii).number(loop.depth).close("]");
  }
  line.close("]").close("}").close("}").end(out);
}

void write_command(const Record& record, const RecordedCommand& c, Line& line, std::ostream& out) {
  line.open("{").key("command").open("{").key("kind").text(std::string(to_string(c.kind)));
  line.key("name").number(c.name).key("task").number(c.task).key("frame").number(c.frame);
  line.key("queue").id(c.queue).key("thread").number(c.thread).key("work").id(c.work);
  line.key("launch").open("[").number(c.launch.groups).number(c.launch.group_items);
  line.number(c.launch.local_bytes).close("]").key("demand").open("[");
  line.number(c.demand.launch_ns).number(c.demand.compute_ns).number(c.demand.memory_ns);
  line.number(c.demand.bytes).number(c.demand.units).close("]").key("bytes").number(c.bytes);
  line.key("units").number(c.compute_units).key("waits");
  if (c.has_list) {
    line.open("[");
    for (std::uint32_t i = 0; i < c.wait_count; ++i) line.number(record.waits[c.first_wait + i]);
    line.close("]");
  } else {
    line.id(kNone);
  }
  line.key("measured").open("[").number(c.measured_start).number(c.measured_end).close("]");
  line.key("live").open("[");
  if (c.resolved) {
    line.number(c.live.queued).number(c.live.submit).number(c.live.start).number(c.live.end);
  }
  line.close("]").close("}").close("}").end(out);
}

void write_actions(const Record& record, std::uint32_t thread, std::ostream& out) {
  Line line;
  const auto& actions = record.threads[thread].actions;
  for (std::size_t from = 0; from < actions.size(); from += kActionsPerLine) {
    line.open("{").key("actions").open("{").key("thread").number(thread).key("list").open("[");
    for (std::size_t i = from; i < std::min(from + kActionsPerLine, actions.size()); ++i) {
      const Action& a = actions[i];
      line.open("[").number(static_cast<std::uint32_t>(a.type));
      if (a.type == ActionType::wait) {
        for (std::uint64_t w = 0; w < a.value; ++w) line.number(record.waits[a.arg + w]);
      } else if (a.type == ActionType::wait_until) {
        line.number(a.value);
      } else {
        line.number(a.arg);
        if (a.type == ActionType::set_event) line.number(a.value);
      }
      line.close("]");
    }
    line.close("]").close("}").close("}").end(out);
  }
}

}  // namespace

void write_record(const Record& record, std::ostream& out) {
  Line line;
  const Layout& layout = record.layout;
  line.open("{").key("partita_record").number(1u).key("machine").text(layout.machine);
  line.key("machine_hash").text(layout.machine_hash).key("main_node").number(layout.main_node);
  line.key("sensor_node").number(layout.sensor_node).key("complete").flag(record.complete);
  line.close("}").end(out);
  write_layout(layout, out);
  for (const auto& name : record.names) line.open("{").key("name").text(name).close("}").end(out);
  for (const auto& q : record.queues) {
    line.open("{").key("queue").open("{").key("device").number(q.device);
    line.key("out_of_order").flag(q.out_of_order).close("}").close("}").end(out);
  }
  for (const Work& work : record.works) write_work(work, out);
  for (const auto& t : record.threads) {
    line.open("{").key("thread").open("{").key("name").text(t.name).key("rank").id(t.rank);
    line.key("node").number(t.node).key("start").number(t.start).key("after").id(t.after);
    line.key("at").number(static_cast<std::uint32_t>(t.at)).close("}").close("}").end(out);
  }
  for (const auto& c : record.commands) write_command(record, c, line, out);
  for (std::uint32_t t = 0; t < record.threads.size(); ++t) write_actions(record, t, out);
  line.open("{").key("end").number(std::uint64_t{record.commands.size()}).close("}").end(out);
}

void save_record(const Record& record, const std::string& path) {
  namespace fs = std::filesystem;
  const std::string temporary = path + ".partial";
  std::error_code error;
  {
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    if (!out) throw profile::Error(path + ": cannot be written, expected a writable folder");
    write_record(record, out);
    out.flush();
    if (!out) {
      out.close();
      fs::remove(temporary, error);
      throw profile::Error(path + ": cannot be written to its end, expected room on the disk");
    }
  }
  fs::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw profile::Error(path + ": cannot be replaced (" + error.message() + ")");
  }
}

}  // namespace partita::timeline
