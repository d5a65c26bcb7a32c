// Pipeline: the task graph as data, read from profiles/pipelines/*.yaml: which tasks there are,
// what passes between them, how often each runs, how deep its queue is and what happens when it is
// full.
#ifndef PARTITA_PARTITION_GRAPH_PIPELINE_H
#define PARTITA_PARTITION_GRAPH_PIPELINE_H

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "devices/profile/profile.h"

namespace partita::partition {

struct Workload;

/// What a task does with frames that arrive faster than it takes them. Frames wait in its queue.
enum class WhenFull : std::uint8_t {
  keep,         ///< the queue has no bound: every frame is processed, lateness accumulates
  drop_oldest,  ///< the frame that waited longest makes room
  drop_newest,  ///< the arriving frame is lost
};
std::string_view to_string(WhenFull when_full);

/// An input of a task. A task runs on frame k when all its inputs whose producers run on frame k
/// are there; of the others the latest earlier message is used, without waiting.
struct Input {
  std::uint32_t task = 0;  ///< index of the producer
  std::string output;      ///< which of its outputs: how many bytes cross a link
  bool operator==(const Input&) const = default;
};

struct PipelineTask {
  std::string name;
  std::string branch;         ///< "localization", "scene" or empty: what --pin and run call it
  std::uint32_t every = 1;    ///< runs on every k-th frame, the first included
  std::vector<Input> inputs;  ///< empty: fed by the sensors, with `sensor_bytes` a frame
  std::uint64_t sensor_bytes = 0;
  std::uint32_t sensor_pictures = 0;  ///< of them, for resize(): pictures of one byte a pixel
  std::string sensor = "stereo";      ///< name of what the sensors send
  std::uint32_t queue_depth = 1;      ///< frames that wait, beyond the one in work; not with `keep`
  WhenFull when_full = WhenFull::keep;
  std::uint64_t deadline_ns = 0;  ///< from the frame's trigger to the task's end; 0: the period
  bool host_only = false;         ///< as the tasks say: checked against the workload
};

struct Pipeline {
  std::string id;  ///< the file's stem
  std::string description;
  std::uint64_t period_ns = 0;  ///< of the cameras
  std::uint32_t imu_hz = 0;
  std::uint32_t width = 0, height = 0;  ///< of a camera's picture
  /// In topological order, otherwise as in the file; ties in virtual time follow it.
  std::vector<PipelineTask> tasks;
  std::vector<std::uint32_t> perception;  ///< tasks whose slowest is the perception latency
  std::vector<std::uint32_t> outputs;     ///< tasks whose slowest is the end-to-end latency
  std::string path, content_hash;

  /// Index of the task; throws profile::Error that lists the names there are.
  std::uint32_t index_of(std::string_view task) const;
};

/// Reads strictly: unknown keys, a cycle (which is spelled out), an input from a task that does not
/// exist, numbers out of range throw profile::Error ("<file>:<line>: <key>: …, expected …"). `what`
/// is a path (has '/' or ends in .yaml) or a name below `<profiles>/pipelines`.
Pipeline load_pipeline(const std::string& what, const std::string& profiles);
Pipeline parse_pipeline(const std::string& text, const std::string& path);
std::vector<std::string> list_pipelines(const std::string& profiles);

/// The same pipeline for other cameras: pictures of width x height pixels (64..4096 either way),
/// what the sensors send included. Throws profile::Error.
void resize(Pipeline& pipeline, std::uint32_t width, std::uint32_t height);

/// Throws profile::Error unless the workload has every task of the pipeline, with the outputs that
/// others read, and both agree on which tasks have no kernels.
void check(const Pipeline& pipeline, const Workload& workload);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_GRAPH_PIPELINE_H
