#include "host/tasks/sensing/synchronise.h"

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::sensing {

void check_synchronised(const std::string& frame, std::int64_t left_ns, std::int64_t right_ns,
                        std::int64_t tolerance_ns) {
  const std::int64_t apart = left_ns < right_ns ? right_ns - left_ns : left_ns - right_ns;
  if (apart <= tolerance_ns) return;
  throw Error(
      fmt::format("{}: left at {} ns and right at {} ns are out of sync, expected at most "
                  "{} ns between them",
                  frame, left_ns, right_ns, tolerance_ns));
}

}  // namespace partita::sensing
