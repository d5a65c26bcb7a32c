#include "partition/graph/pipeline.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "devices/profile/reader.h"
#include "partition/graph/workload.h"

namespace fs = std::filesystem;

namespace partita::partition {
namespace {

using profile::Error;
using profile::Range;
using profile::Reader;

constexpr Range kSide{"", 64, 4096};
constexpr Range kBytes{"B", 0, 1e10};
constexpr std::size_t kMostTasks = 64;
const std::vector<std::string_view> kWhenFull{"keep", "drop_oldest", "drop_newest"};

std::vector<std::string> names_of(const std::vector<PipelineTask>& tasks) {
  std::vector<std::string> names;
  for (const PipelineTask& task : tasks) names.push_back(task.name);
  return names;
}

/// As a file has it, shortened: errors stay on one line that can be read.
std::string quoted(const std::string& text) {
  std::string shown = text.substr(0, 40);
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 32; }, ' ');
  return shown.insert(0, 1, '\'').append("'");
}

/// Builds a Pipeline from its text; tasks keep the file's order until sort().
class PipelineReader {
 public:
  PipelineReader(const std::string& text, const std::string& path)
      : reader_(Reader::parse(text, path, nullptr)) {
    pipeline_.path = path;
    pipeline_.id = fs::path(path).stem().string();
    pipeline_.content_hash = profile::hash_bytes(text);
  }

  Pipeline read() {
    reader_.allow({"description", "cameras", "imu", "tasks", "perception", "outputs"});
    pipeline_.description = reader_.text("description");
    read_sensors();
    const Reader tasks = reader_.section("tasks");
    tasks.allow({tasks_keys_.begin(), tasks_keys_.end()});
    for (const std::string& name : tasks_keys_) read_task(tasks.section(name), name);
    for (std::uint32_t i = 0; i < pipeline_.tasks.size(); ++i) {
      read_inputs(tasks.section(pipeline_.tasks[i].name), i);
    }
    sort(tasks);
    pipeline_.perception = read_ends("perception");
    pipeline_.outputs = read_ends("outputs");
    return std::move(pipeline_);
  }

 private:
  void read_sensors() {
    const Reader cameras = reader_.section("cameras");
    cameras.allow({"rate", "width", "height"});
    pipeline_.period_ns =
        static_cast<std::uint64_t>(std::llround(1e9 / cameras.number("rate", {"Hz", 0.1, 1000})));
    pipeline_.width = static_cast<std::uint32_t>(cameras.integer("width", kSide));
    pipeline_.height = static_cast<std::uint32_t>(cameras.integer("height", kSide));
    if (reader_.has("imu")) {
      const Reader imu = reader_.section("imu");
      imu.allow({"rate"});
      pipeline_.imu_hz = static_cast<std::uint32_t>(imu.integer("rate", {"Hz", 1, 10000}));
    }
    tasks_keys_ = reader_.section("tasks").keys();
    if (tasks_keys_.empty() || tasks_keys_.size() > kMostTasks) {
      reader_.fail("tasks", std::to_string(tasks_keys_.size()) + " tasks, expected 1 to " +
                                std::to_string(kMostTasks));
    }
  }

  void read_task(const Reader& from, const std::string& name) {
    if (!profile::plain_name(name)) {
      reader_.fail("tasks", quoted(name) + " is not a name, expected letters, digits, '-' and '_'");
    }
    from.allow({"branch", "every", "inputs", "sensor", "queue", "deadline", "host_only"});
    PipelineTask task;
    task.name = name;
    if (from.has("branch")) task.branch = from.text("branch");
    if (from.has("every")) {
      task.every = static_cast<std::uint32_t>(from.integer("every", {"", 1, 1000}));
    }
    if (from.has("host_only")) task.host_only = from.flag("host_only");
    if (from.has("deadline")) task.deadline_ns = from.integer("deadline", {"ns", 1, 1e11});
    if (from.has("queue")) read_queue(from.section("queue"), task);
    if (from.has("sensor") == from.has("inputs")) {
      from.fail("inputs", from.has("inputs") ? "beside 'sensor', expected one of them"
                                             : "missing, expected 'inputs' or 'sensor'");
    }
    if (from.has("sensor")) read_sensor(from.section("sensor"), task);
    pipeline_.tasks.push_back(task);
  }

  static void read_queue(const Reader& from, PipelineTask& task) {
    from.allow({"depth", "when_full"});
    task.when_full = static_cast<WhenFull>(from.choice("when_full", kWhenFull));
    if (!from.has("depth")) return;
    task.queue_depth = static_cast<std::uint32_t>(from.integer("depth", {"", 1, 1000}));
    if (task.when_full == WhenFull::keep) {
      from.fail("depth", "given with 'keep', expected none: such a queue has no bound");
    }
  }

  void read_sensor(const Reader& from, PipelineTask& task) const {
    from.allow({"name", "pictures", "bytes"});
    task.sensor = from.text("name");
    if (from.has("bytes")) task.sensor_bytes = from.integer("bytes", kBytes);
    if (from.has("pictures")) {
      task.sensor_pictures = static_cast<std::uint32_t>(from.integer("pictures", {"", 1, 64}));
      task.sensor_bytes += std::uint64_t{task.sensor_pictures} * pipeline_.width * pipeline_.height;
    }
    if (task.sensor_bytes == 0) from.fail("", "sends nothing, expected 'pictures' or 'bytes'");
  }

  void read_inputs(const Reader& from, std::uint32_t index) {
    if (!from.has("inputs")) return;
    std::vector<Input>& inputs = pipeline_.tasks[index].inputs;
    for (const std::string& text : from.texts("inputs")) {
      const std::size_t dot = text.find('.');
      if (dot == std::string::npos || !profile::plain_name(text.substr(dot + 1))) {
        from.fail("inputs", quoted(text) + ", expected TASK.OUTPUT");
      }
      const Input input{find(from, "inputs", text.substr(0, dot)), text.substr(dot + 1)};
      for (const Input& other : inputs) {
        if (other == input) from.fail("inputs", quoted(text) + " twice, expected once");
      }
      inputs.push_back(input);
    }
    if (inputs.empty()) from.fail("inputs", "is empty, expected at least one TASK.OUTPUT");
  }

  std::uint32_t find(const Reader& from, std::string_view key, const std::string& name) const {
    const auto& tasks = pipeline_.tasks;
    const auto found = std::find_if(tasks.begin(), tasks.end(),
                                    [&](const PipelineTask& task) { return task.name == name; });
    if (found == tasks.end()) {
      from.fail(
          key, "no task " + quoted(name) + ", expected one of " + profile::listed(names_of(tasks)));
    }
    return static_cast<std::uint32_t>(found - tasks.begin());
  }

  /// Producers before consumers; otherwise the file's order stays.
  void sort(const Reader& from) {
    std::vector<PipelineTask>& tasks = pipeline_.tasks;
    std::vector<std::uint32_t> place(tasks.size(), kUnplaced), order;
    while (order.size() < tasks.size()) {
      std::uint32_t next = 0;
      while (next < tasks.size() && (place[next] != kUnplaced || !ready(tasks[next], place))) {
        ++next;
      }
      if (next == tasks.size()) from.fail(cycle_start(place), "a cycle: " + cycle(place));
      place[next] = static_cast<std::uint32_t>(order.size());
      order.push_back(next);
    }
    std::vector<PipelineTask> sorted;
    for (const std::uint32_t index : order) sorted.push_back(tasks[index]);
    for (PipelineTask& task : sorted) {
      for (Input& input : task.inputs) input.task = place[input.task];
    }
    tasks = std::move(sorted);
  }

  static bool ready(const PipelineTask& task, const std::vector<std::uint32_t>& place) {
    return std::all_of(task.inputs.begin(), task.inputs.end(),
                       [&](const Input& input) { return place[input.task] != kUnplaced; });
  }

  /// The first producer of a task that is itself not placed: following it must come round.
  std::uint32_t blocked_by(std::uint32_t task, const std::vector<std::uint32_t>& place) const {
    const auto& inputs = pipeline_.tasks[task].inputs;
    return std::find_if(inputs.begin(), inputs.end(),
                        [&](const Input& input) { return place[input.task] == kUnplaced; })
        ->task;
  }

  std::uint32_t on_cycle(const std::vector<std::uint32_t>& place) const {
    auto task = static_cast<std::uint32_t>(std::find(place.begin(), place.end(), kUnplaced) -
                                           place.begin());
    for (std::size_t i = 0; i < place.size(); ++i) task = blocked_by(task, place);
    return task;
  }

  std::string cycle_start(const std::vector<std::uint32_t>& place) const {
    return pipeline_.tasks[on_cycle(place)].name;
  }

  /// "tracking <- detection <- tracking": who waits for whom.
  std::string cycle(const std::vector<std::uint32_t>& place) const {
    const std::uint32_t first = on_cycle(place);
    std::string text = pipeline_.tasks[first].name;
    for (std::uint32_t task = blocked_by(first, place);; task = blocked_by(task, place)) {
      text += " <- " + pipeline_.tasks[task].name;
      if (task == first) return text + ", expected tasks that wait for earlier ones only";
    }
  }

  std::vector<std::uint32_t> read_ends(std::string_view key) const {
    std::vector<std::uint32_t> ends;
    for (const std::string& name : reader_.texts(key)) {
      ends.push_back(find(reader_, key, name));
      if (std::count(ends.begin(), ends.end(), ends.back()) > 1) {
        reader_.fail(key, quoted(name) + " twice, expected once");
      }
    }
    if (ends.empty()) reader_.fail(key, "is empty, expected at least one task");
    return ends;
  }

  static constexpr std::uint32_t kUnplaced = 0xFFFFFFFFu;
  Reader reader_;
  std::vector<std::string> tasks_keys_;
  Pipeline pipeline_;
};

}  // namespace

std::string_view to_string(WhenFull when_full) {
  return kWhenFull[static_cast<std::size_t>(when_full)];
}

std::uint32_t Pipeline::index_of(std::string_view task) const {
  for (std::uint32_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].name == task) return i;
  }
  throw Error("no task " + quoted(std::string(task)) + " in pipeline " + id + ", expected one of " +
              profile::listed(names_of(tasks)));
}

Pipeline parse_pipeline(const std::string& text, const std::string& path) try {
  return PipelineReader(text, path).read();
} catch (const YAML::Exception& e) {
  throw Error(path + ":" + std::to_string(std::max(e.mark.line, 0) + 1) + ": " + e.msg);
}

Pipeline load_pipeline(const std::string& what, const std::string& profiles) {
  std::string path = what;
  if (what.find('/') == std::string::npos && !what.ends_with(".yaml")) {
    const auto names = list_pipelines(profiles);
    if (std::find(names.begin(), names.end(), what) == names.end()) {
      throw Error("pipeline '" + what + "': not in " + profiles + "/pipelines, expected one of " +
                  profile::listed(names));
    }
    path = (fs::path(profiles) / "pipelines" / (what + ".yaml")).string();
  }
  return parse_pipeline(profile::read_file(path), path);
}

std::vector<std::string> list_pipelines(const std::string& profiles) {
  return profile::yaml_stems((fs::path(profiles) / "pipelines").string());
}

void resize(Pipeline& pipeline, std::uint32_t width, std::uint32_t height) {
  const auto fits = [](std::uint32_t side) { return side >= kSide.low && side <= kSide.high; };
  if (!fits(width) || !fits(height)) {
    throw Error("pictures of " + std::to_string(width) + " x " + std::to_string(height) +
                ", expected 64 to 4096 either way");
  }
  const std::uint64_t before = std::uint64_t{pipeline.width} * pipeline.height;
  const std::uint64_t after = std::uint64_t{width} * height;
  for (PipelineTask& task : pipeline.tasks) {
    task.sensor_bytes =
        task.sensor_bytes - task.sensor_pictures * before + task.sensor_pictures * after;
  }
  pipeline.width = width;
  pipeline.height = height;
}

void check(const Pipeline& pipeline, const Workload& workload) {
  for (const PipelineTask& task : pipeline.tasks) {
    const std::string where = "pipeline " + pipeline.id + ", task " + task.name + ": ";
    const TaskWork* work = workload.find(task.name);
    if (work == nullptr) {
      throw Error(where + "not in the workload, expected a task that it has");
    }
    if (work->host_only != task.host_only) {
      throw Error(where + "host_only is " + (task.host_only ? "true" : "false") +
                  ", expected the opposite: the task has " +
                  (work->host_only ? "no kernels" : "kernels"));
    }
    for (const Input& input : task.inputs) {
      const std::string& producer = pipeline.tasks[input.task].name;
      const TaskWork* from = workload.find(producer);
      std::vector<std::string> names;
      for (const Output& output : from ? from->outputs : std::vector<Output>{}) {
        names.push_back(output.name);
      }
      if (std::find(names.begin(), names.end(), input.output) == names.end()) {
        throw Error(where + "input " + producer + "." + input.output +
                    ": no such output, expected one of " + profile::listed(names));
      }
    }
  }
}

}  // namespace partita::partition
