// Chrome trace events, as Perfetto and chrome://tracing open them.
#ifndef PARTITA_HOST_IO_TRACE_H
#define PARTITA_HOST_IO_TRACE_H

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "host/io/file.h"

namespace partita::io {

/// Writes a trace event by event: nothing is kept in memory, and the file appears, whole, with
/// close(). Predicted and measured times belong into separate processes; one lane per engine.
/// Times are integer nanoseconds on the process's own clock and keep their last digit.
/// Not for several threads at once. Failures to write are Errors that name the file.
class TraceWriter {
 public:
  struct Lane {
    int process = 0;
    int lane = 0;
  };

  explicit TraceWriter(const std::string& path);

  int process(std::string_view name);             ///< shown in the order of creation
  Lane lane(int process, std::string_view name);  ///< likewise

  /// Something that took from start_ns to start_ns + duration_ns (>= 0). Events of one lane must
  /// not overlap unless one lies within the other. `args` is an object shown beside the event.
  void complete(Lane lane, std::string_view name, std::string_view category, std::int64_t start_ns,
                std::int64_t duration_ns, const nlohmann::ordered_json& args);
  void complete(Lane lane, std::string_view name, std::string_view category, std::int64_t start_ns,
                std::int64_t duration_ns);

  /// The value of a curve from now on, memory in use for instance.
  void counter(int process, std::string_view name, std::int64_t time_ns, double value);

  void close();  ///< to be called once, last; without it no file appears

 private:
  void event(const nlohmann::ordered_json& fields, std::string_view times);

  AtomicFile file_;
  bool first_ = true;
  int processes_ = 0;
  std::map<int, int> lanes_;
};

}  // namespace partita::io

#endif  // PARTITA_HOST_IO_TRACE_H
