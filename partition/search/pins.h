// Pins: "depth=gpu", what the user has decided already. And the space of placements that they
// leave.
#ifndef PARTITA_PARTITION_SEARCH_PINS_H
#define PARTITA_PARTITION_SEARCH_PINS_H

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "partition/search/evaluator.h"

namespace partita::partition {

struct Pin {
  std::string what;   ///< a task, or a branch: its tasks that have kernels
  std::string where;  ///< "fpga", "gpu", "cpu"; a profile's id; a node; or a part, of at least
                      ///< three characters, of a device's name (case-insensitive)
  std::string to_string() const { return what + "=" + where; }
};

/// What pins are refused with: another machine may satisfy them.
class PinError : public profile::Error {
 public:
  using Error::Error;
};

/// Reads "TASK=DEVICE", spaces around names allowed. Throws PinError for anything else.
Pin parse_pin(std::string_view text);

/// Per task the places that the pins leave, ascending indices into Evaluator::places(task).
using Choices = std::vector<std::vector<std::uint32_t>>;

/// Throws PinError: an unknown task, a device that the machine lacks, a task that cannot run
/// there, two pins that contradict each other. One line that says what there is.
Choices choices(const Evaluator& evaluator, std::span<const Pin> pins);

/// Number of placements, at most 2^64 - 1.
std::uint64_t count(const Choices& choices);
/// The placement with that number; placements are ordered as numbers whose first digit is task 0.
TaskPlacement nth(const Choices& choices, std::uint64_t number);

}  // namespace partita::partition

#endif  // PARTITA_PARTITION_SEARCH_PINS_H
