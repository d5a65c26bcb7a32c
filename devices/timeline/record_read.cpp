// Reads a record back. Each line is one JSON object with one key that says what it is: the header,
// then node, device, link, name, queue, work, thread, command, actions, and end. Keys of an object
// are all required and no others are allowed.
#include <fstream>
#include <limits>
#include <sstream>

#include <nlohmann/json.hpp>

#include "devices/timeline/record.h"

namespace partita::timeline {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 50;

class Parser {
 public:
  explicit Parser(std::string path) : path_(std::move(path)) {}

  Record parse(std::istream& in) {
    std::string text;
    while (std::getline(in, text)) {
      ++line_;
      if (ended_) fail("something after the end line, expected nothing");
      const json value = json::parse(text, nullptr, false);
      if (value.is_discarded() || !value.is_object() || value.empty()) {
        fail("not a JSON object, expected one on every line");
      }
      line_ == 1 ? header(value) : entry(value);
    }
    if (!ended_) {
      ++line_;
      fail("the end line is missing, expected a whole record");
    }
    finish();
    return std::move(record_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw profile::Error(path_ + ":" + std::to_string(line_) + ": " + what);
  }

  void keys(const json& object, std::initializer_list<const char*> names) const {
    if (!object.is_object()) fail("a value where an object is expected");
    for (const char* name : names) {
      if (!object.contains(name)) fail("no key '" + std::string(name) + "', expected it");
    }
    if (object.size() != names.size()) fail("unknown keys, expected none");
  }
  std::uint64_t number(const json& value, const char* key, std::uint64_t most) const {
    if (!value.is_number_unsigned()) {
      fail(std::string(key) + ": expected a whole number in [0, " + std::to_string(most) + "]");
    }
    const auto result = value.get<std::uint64_t>();
    if (result > most) {
      fail(std::string(key) + ": " + std::to_string(result) + ", expected at most " +
           std::to_string(most));
    }
    return result;
  }
  std::uint64_t at(const json& object, const char* key, std::uint64_t most) const {
    return number(object.at(key), key, most);
  }
  /// An index below `count`.
  std::uint32_t index(const json& value, const char* key, std::size_t count) const {
    if (count == 0) fail(std::string(key) + ": refers to something that is not there");
    return static_cast<std::uint32_t>(number(value, key, count - 1));
  }
  std::uint32_t optional_index(const json& value, const char* key, std::size_t count) const {
    return value.is_null() ? kNone : index(value, key, count);
  }
  bool flag(const json& object, const char* key) const {
    if (!object.at(key).is_boolean()) fail(std::string(key) + ": expected true or false");
    return object.at(key).get<bool>();
  }
  std::string text(const json& value, const char* key) const {
    if (!value.is_string()) fail(std::string(key) + ": expected a text");
    return value.get<std::string>();
  }
  const json& list(const json& value, const char* key, std::size_t least, std::size_t most) const {
    if (!value.is_array() || value.size() < least || value.size() > most) {
      fail(std::string(key) + ": expected a list of " + std::to_string(least) + " to " +
           std::to_string(most));
    }
    return value;
  }

  void header(const json& o) {
    keys(o, {"partita_record", "machine", "machine_hash", "main_node", "sensor_node", "complete"});
    if (o.at("partita_record") != 1) fail("partita_record: another version, expected 1");
    record_.layout.machine = text(o.at("machine"), "machine");
    record_.layout.machine_hash = text(o.at("machine_hash"), "machine_hash");
    record_.layout.main_node = static_cast<std::uint32_t>(at(o, "main_node", kNone));
    record_.layout.sensor_node = static_cast<std::uint32_t>(at(o, "sensor_node", kNone));
    record_.complete = flag(o, "complete");
    record_.names.clear();
  }

  void entry(const json& o) {
    if (o.size() != 1) fail("more than one key, expected one");
    const std::string& key = o.begin().key();
    const json& value = o.begin().value();
    if (key == "node") return node(value);
    if (key == "device") return device(value);
    if (key == "link") return link(value);
    if (key == "name") return record_.names.push_back(text(value, "name"));
    if (key == "queue") return queue(value);
    if (key == "work") return work(value);
    if (key == "thread") return thread(value);
    if (key == "command") return command(value);
    if (key == "actions") return actions(value);
    if (key != "end") fail("unknown key '" + key.substr(0, 40) + "'");
    if (number(value, "end", kNone) != record_.commands.size()) {
      fail("end: another number of commands than there are, expected a whole record");
    }
    ended_ = true;
  }

  void node(const json& o) {
    keys(o, {"name", "cores", "memory_bps", "unit_memory_bps", "api_call_ns", "wakeup_ns"});
    LayoutNode n;
    n.name = text(o.at("name"), "name");
    n.cores = static_cast<std::uint32_t>(at(o, "cores", 4096));
    n.memory_bps = at(o, "memory_bps", kBig);
    n.unit_memory_bps = at(o, "unit_memory_bps", kBig);
    n.api_call_ns = at(o, "api_call_ns", kBig);
    n.wakeup_ns = at(o, "wakeup_ns", kBig);
    record_.layout.nodes.push_back(n);
  }

  void device(const json& o) {
    keys(o, {"name", "type", "node", "is_host_cpu", "shared_memory", "memory_bps", "link_bps",
             "link_latency_ns", "api_call_ns", "submit_ns", "wakeup_ns"});
    LayoutDevice d;
    d.name = text(o.at("name"), "name");
    const std::string type = text(o.at("type"), "type");
    d.type = type == "gpu"    ? profile::DeviceType::gpu
             : type == "fpga" ? profile::DeviceType::fpga
                              : profile::DeviceType::cpu;
    if (type != profile::to_string(d.type)) fail("type: expected cpu, gpu or fpga");
    d.node = static_cast<std::uint32_t>(at(o, "node", kNone));
    d.is_host_cpu = flag(o, "is_host_cpu");
    d.shared_memory = flag(o, "shared_memory");
    d.memory_bps = at(o, "memory_bps", kBig);
    d.link_bps = at(o, "link_bps", kBig);
    d.link_latency_ns = at(o, "link_latency_ns", kBig);
    d.api_call_ns = at(o, "api_call_ns", kBig);
    d.submit_ns = at(o, "submit_ns", kBig);
    d.wakeup_ns = at(o, "wakeup_ns", kBig);
    record_.layout.devices.push_back(d);
  }

  void link(const json& o) {
    keys(o, {"name", "a", "b", "bps", "latency_ns"});
    record_.layout.links.push_back({text(o.at("name"), "name"),
                                    static_cast<std::uint32_t>(at(o, "a", kNone)),
                                    static_cast<std::uint32_t>(at(o, "b", kNone)),
                                    at(o, "bps", kBig), at(o, "latency_ns", kBig)});
  }

  void queue(const json& o) {
    keys(o, {"device", "out_of_order"});
    record_.queues.push_back(
        {index(o.at("device"), "device", record_.layout.devices.size()), flag(o, "out_of_order")});
  }

  void work(const json& o) {
    keys(o, {"kind", "ops", "bytes", "estimated", "loops"});
    Work w;
    const std::string kind = text(o.at("kind"), "kind");
    std::uint32_t k = 0;
    while (k < kWorkKinds && kind != model::to_string(static_cast<WorkKind>(k))) ++k;
    if (k == kWorkKinds) fail("kind: no such kind of work");
    w.kind = static_cast<WorkKind>(k);
    const json& ops = list(o.at("ops"), "ops", kOpClasses, kOpClasses);
    for (std::size_t i = 0; i < kOpClasses; ++i) w.ops[i] = number(ops[i], "ops", kAny);
    const json& bytes = list(o.at("bytes"), "bytes", 5, 5);
    std::uint64_t* const fields[] = {&w.read_issued, &w.written_issued, &w.read_unique,
                                     &w.written_unique, &w.local_bytes};
    for (std::size_t i = 0; i < 5; ++i) *fields[i] = number(bytes[i], "bytes", kAny);
    w.estimated = flag(o, "estimated") ? 1 : 0;
    for (const json& loop : list(o.at("loops"), "loops", 0, kMaxWorkLoops)) {
      list(loop, "loops", 3, 3);
      w.loops[w.loop_count++] = {number(loop[0], "trips", kAny),
                                 static_cast<std::uint32_t>(number(loop[1], "ii", kNone)),
                                 static_cast<std::uint32_t>(number(loop[2], "depth", kNone))};
    }
    record_.works.push_back(w);
  }

  void thread(const json& o) {
    keys(o, {"name", "rank", "node", "start", "after", "at"});
    RecordedThread t;
    t.name = text(o.at("name"), "name");
    t.rank = optional_index(o.at("rank"), "rank", kNone);
    t.node = index(o.at("node"), "node", record_.layout.nodes.size());
    t.start = at(o, "start", kLatest);
    t.after = optional_index(o.at("after"), "after", kNone);  // checked when all are known
    t.at = static_cast<CallbackAt>(at(o, "at", 2));
    record_.threads.push_back(t);
  }

  void command(const json& o) {
    keys(o, {"kind", "name", "task", "frame", "queue", "thread", "work", "launch", "demand",
             "bytes", "units", "waits", "measured", "live"});
    RecordedCommand c;
    const std::string kind = text(o.at("kind"), "kind");
    while (c.kind < CommandKind::count_ && kind != to_string(c.kind)) {
      c.kind = static_cast<CommandKind>(static_cast<int>(c.kind) + 1);
    }
    if (c.kind == CommandKind::count_) fail("kind: no such kind of command");
    c.name = index(o.at("name"), "name", record_.names.size());
    c.task = index(o.at("task"), "task", record_.names.size());
    if (!o.at("frame").is_number_integer()) fail("frame: expected a whole number");
    c.frame = o.at("frame").get<std::int64_t>();
    c.queue = optional_index(o.at("queue"), "queue", record_.queues.size());
    if ((c.queue == kNone) != (c.kind >= CommandKind::host_step)) {
      fail("queue: expected one for commands, and none for host steps, sensors and user events");
    }
    c.thread = index(o.at("thread"), "thread", record_.threads.size());
    c.work = optional_index(o.at("work"), "work", record_.works.size());
    const json& launch = list(o.at("launch"), "launch", 3, 3);
    c.launch = {number(launch[0], "launch", kAny), number(launch[1], "launch", kAny),
                number(launch[2], "launch", kAny)};
    const json& demand = list(o.at("demand"), "demand", 5, 5);
    c.demand = {number(demand[0], "demand", kLongest), number(demand[1], "demand", kLongest),
                number(demand[2], "demand", kLongest), number(demand[3], "demand", kMostBytes),
                static_cast<std::uint32_t>(number(demand[4], "demand", kNone))};
    if (c.demand.units == 0) fail("demand: 0 units, expected at least 1");
    c.bytes = at(o, "bytes", kMostBytes);
    c.compute_units = static_cast<std::uint32_t>(at(o, "units", 64));
    waits_of(o.at("waits"), c);
    if (c.kind == CommandKind::message &&
        (c.wait_count != 1 || record_.commands[record_.waits[c.first_wait]].kind !=
                                  CommandKind::user_event)) {
      fail("waits: expected one user event, which the message is of");
    }
    const json& measured = list(o.at("measured"), "measured", 2, 2);
    c.measured_start = number(measured[0], "measured", kAny);
    c.measured_end = number(measured[1], "measured", kAny);
    const json& live = o.at("live");
    if (!live.is_array() || (!live.empty() && live.size() != 4))
      fail("live: expected 0 or 4 times");
    c.resolved = !live.empty();
    if (c.resolved) {
      c.live = {number(live[0], "live", kAny), number(live[1], "live", kAny),
                number(live[2], "live", kAny), number(live[3], "live", kAny)};
    }
    record_.commands.push_back(c);
  }

  void waits_of(const json& waits, RecordedCommand& c) {
    c.first_wait = static_cast<std::uint32_t>(record_.waits.size());
    c.has_list = !waits.is_null();
    if (waits.is_null()) return;
    for (const json& on : list(waits, "waits", 0, kNone)) {
      record_.waits.push_back(index(on, "waits", record_.commands.size()));
    }
    c.wait_count = static_cast<std::uint32_t>(waits.size());
  }

  void actions(const json& o) {
    keys(o, {"thread", "list"});
    const std::uint32_t thread = index(o.at("thread"), "thread", record_.threads.size());
    for (const json& entry : list(o.at("list"), "list", 0, kNone)) action(thread, entry);
  }

  void action(std::uint32_t thread, const json& entry) {
    list(entry, "list", 1, kNone);
    Action a;
    a.type = static_cast<ActionType>(number(entry[0], "list", 5));
    const std::size_t commands = record_.commands.size();
    const bool valued = a.type == ActionType::set_event;
    if (a.type == ActionType::wait) {
      a.arg = static_cast<std::uint32_t>(record_.waits.size());
      a.value = entry.size() - 1;
      for (std::size_t i = 1; i < entry.size(); ++i) {
        record_.waits.push_back(index(entry[i], "list", commands));
      }
    } else {
      list(entry, "list", valued ? 3 : 2, valued ? 3 : 2);
      if (a.type == ActionType::wait_until) {
        a.value = number(entry[1], "list", kLatest);
      } else {
        a.arg = index(entry[1], "list",
                      a.type == ActionType::finish ? record_.queues.size() : commands);
      }
      if (valued) a.value = number(entry[2], "list", std::numeric_limits<std::int32_t>::max());
    }
    if (a.type == ActionType::command) {
      seen_.resize(commands);
      if (seen_[a.arg] || record_.commands[a.arg].thread != thread) {
        fail("list: command " + std::to_string(a.arg) + " twice or in another thread's list");
      }
      seen_[a.arg] = true;
    }
    if (valued && record_.commands[a.arg].kind != CommandKind::user_event) {
      fail("list: command " + std::to_string(a.arg) + " is set, expected a user event");
    }
    record_.threads[thread].actions.push_back(a);
  }

  void finish() {
    if (record_.names.empty() || !record_.names.front().empty()) {
      fail("names: expected the empty one first");
    }
    for (const RecordedThread& t : record_.threads) {
      if (t.after != kNone && t.after >= record_.commands.size()) fail("after: no such command");
    }
    for (std::size_t i = 0; i < record_.commands.size(); ++i) {
      if (i >= seen_.size() || !seen_[i]) {
        fail("command " + std::to_string(i) + " is in no thread's list, expected it in one");
      }
    }
    try {
      check_layout(record_.layout);
    } catch (const profile::Error& e) {
      fail(e.what());
    }
  }

  static constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint64_t kBig = 1000000000000000;

  std::string path_;
  std::size_t line_ = 0;
  bool ended_ = false;
  std::vector<bool> seen_;
  Record record_;
};

}  // namespace

Record read_record(std::istream& in, const std::string& path) {
  return Parser(path).parse(in);
}

Record load_record(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw profile::Error(path + ": cannot be read");
  return read_record(in, path);
}

}  // namespace partita::timeline
