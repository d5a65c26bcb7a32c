#include "partition/graph/workload.h"

#include <algorithm>
#include <type_traits>

namespace partita::partition {
namespace {

using profile::Error;

constexpr std::string_view kStepNames[] = {"write", "read", "kernel", "copy", "host", "finish"};

/// Bytes of everything that a hash covers, in order.
class Bytes {
 public:
  template <typename T>
  void add(const T& value) requires std::is_arithmetic_v<T> || std::is_enum_v<T> {
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(const std::string& text) {
    add(text.size());
    text_ += text;
  }
  void add(const Work& work) {
    static_assert(std::has_unique_object_representations_v<Work>, "padding would be hashed");
    text_.append(reinterpret_cast<const char*>(&work), sizeof work);
  }
  std::string hash() const { return profile::hash_bytes(text_); }

 private:
  std::string text_;
};

void add(Bytes& bytes, const Step& step) {
  bytes.add(step.kind);
  bytes.add(step.name);
  bytes.add(step.bytes);
  bytes.add(step.blocking);
  bytes.add(step.work);
  bytes.add(step.circuit.clock_hz);
  bytes.add(step.circuit.memory_ports);
  bytes.add(step.circuit.compute_units);
}

std::string hash_of(const TaskWork& task) {
  Bytes bytes;
  bytes.add(task.name);
  bytes.add(task.outline);
  bytes.add(task.host_only);
  for (const bool has : task.variants) bytes.add(has);
  for (const VariantWork& work : task.works) {
    for (const Work& variant : work) bytes.add(variant);
  }
  for (const Program& program : task.frames) {
    bytes.add(program.size());
    for (const Step& step : program) add(bytes, step);
  }
  for (const Output& output : task.outputs) {
    bytes.add(output.name);
    bytes.add(output.bytes);
  }
  const profile::Area& a = task.area;
  for (const std::uint64_t amount : {a.lut, a.ff, a.bram36, a.uram, a.dsp}) bytes.add(amount);
  bytes.add(task.area_declared);
  return bytes.hash();
}

/// The checks of one task; `where_` grows into "task depth, frame 3, step 7 (kernel sobel): ".
class TaskCheck {
 public:
  explicit TaskCheck(const TaskWork& task) : task_(task), where_("task " + task.name) {}

  void run(std::size_t frame_count) const {
    if (task_.name.empty()) fail("has no name, expected one");
    if (task_.frames.empty()) fail("has no frames, expected at least one");
    if (task_.frames.size() != 1 && task_.frames.size() != frame_count) {
      fail(std::to_string(task_.frames.size()) + " frames, expected 1 or " +
           std::to_string(frame_count) + " as the other tasks have");
    }
    const bool any = task_.variants[0] || task_.variants[1] || task_.variants[2];
    if (task_.host_only == any) {
      fail(any ? "has variants, expected none: it has no kernels"
               : "has no variant, expected one for some type of device");
    }
    check_outputs();
    for (std::size_t frame = 0; frame < task_.frames.size(); ++frame) {
      for (std::size_t i = 0; i < task_.frames[frame].size(); ++i) check_step(frame, i);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(where_ + ": " + what); }

  [[noreturn]] void fail(std::size_t frame, std::size_t index, const std::string& what) const {
    const Step& step = task_.frames[frame][index];
    throw Error(where_ + ", frame " + std::to_string(frame) + ", step " + std::to_string(index) +
                " (" + std::string(to_string(step.kind)) +
                (step.name.empty() ? "" : " " + step.name) + "): " + what);
  }

  void check_outputs() const {
    for (auto output = task_.outputs.begin(); output != task_.outputs.end(); ++output) {
      const bool twice = std::any_of(task_.outputs.begin(), output, [&](const Output& other) {
        return other.name == output->name;
      });
      if (output->name.empty() || twice) {
        fail("output '" + output->name + "' has no name or one that is there already");
      }
    }
  }

  void check_step(std::size_t frame, std::size_t index) const {
    const Step& step = task_.frames[frame][index];
    if (step.kind > StepKind::finish) throw Error(where_ + ": a step of an unknown kind");
    if (task_.host_only && step.kind != StepKind::host) {
      fail(frame, index, "a step on a device, expected host steps only: it has no kernels");
    }
    const bool works = step.kind == StepKind::kernel || step.kind == StepKind::host;
    if (!works) return;
    if (step.name.empty()) fail(frame, index, "has no name, expected one");
    if (step.work >= task_.works.size()) {
      fail(frame, index,
           "work " + std::to_string(step.work) + ", expected less than " +
               std::to_string(task_.works.size()));
    }
    const VariantWork& work = task_.works[step.work];
    for (std::size_t variant = 0; variant < kVariants; ++variant) {
      const bool used = step.kind == StepKind::host ? variant == 0 : task_.variants[variant];
      if (used) check_work(frame, index, work[variant], variant);
    }
  }

  void check_work(std::size_t frame, std::size_t index, const Work& work,
                  std::size_t variant) const {
    const std::string name(profile::to_string(static_cast<profile::DeviceType>(variant)));
    if (work.kind >= WorkKind::count_ || work.loop_count > kMaxWorkLoops) {
      fail(frame, index,
           "work of an unknown kind or with too many loops, expected a Work as "
           "devices/work.h has it");
    }
    if (task_.frames[frame][index].kind != StepKind::kernel) return;
    if (work.groups == 0 || work.group_items == 0) {
      fail(frame, index, "no work-group in the " + name + " variant, expected at least one");
    }
  }

  const TaskWork& task_;
  std::string where_;
};

}  // namespace

std::string_view to_string(StepKind kind) {
  return kStepNames[static_cast<std::size_t>(kind)];
}

const TaskWork* Workload::find(std::string_view task) const {
  const auto found = std::find_if(tasks.begin(), tasks.end(),
                                  [task](const TaskWork& work) { return work.name == task; });
  return found == tasks.end() ? nullptr : &*found;
}

std::size_t Workload::frame_count() const {
  std::size_t most = 0;
  for (const TaskWork& task : tasks) most = std::max(most, task.frames.size());
  return most;
}

std::string content_hash(const Workload& workload) {
  std::string hashes = workload.origin;
  for (const TaskWork& task : workload.tasks) hashes.append(" ").append(hash_of(task));
  return profile::hash_bytes(hashes);
}

void check(const Workload& workload) {
  for (const TaskWork& task : workload.tasks) {
    TaskCheck(task).run(workload.frame_count());
    if (workload.find(task.name) != &task) {
      throw Error("task " + task.name + ": twice in the workload, expected once");
    }
  }
}

}  // namespace partita::partition
