#include "devices/timeline/record.h"

namespace partita::timeline {

bool Record::racing() const {
  std::size_t enqueuing = 0;
  for (const RecordedThread& thread : threads) {
    for (const Action& action : thread.actions) {
      if (action.type != ActionType::command) continue;
      ++enqueuing;
      break;
    }
  }
  return enqueuing > 1;
}

}  // namespace partita::timeline
