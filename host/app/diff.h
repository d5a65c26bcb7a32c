// Two runs, or two explorations, side by side.
#ifndef PARTITA_HOST_APP_DIFF_H
#define PARTITA_HOST_APP_DIFF_H

#include <string>

#include "host/app/console.h"

namespace partita::app {

enum class ResultKind { run, exploration };
const char* to_string(ResultKind kind);

struct Result {
  std::string path;  ///< of its JSON file
  ResultKind kind = ResultKind::run;
  Json json;
};

/// Reads summary.json or explore.json: the file, or the one in the folder. Throws Error for
/// anything else.
Result load_result(const std::string& path);

/// What differs: {"kind", "a", "b", "inputs": [{"what", "a", "b"}], "placement": [the same],
/// "figures": [{"section", "figure", "unit", "a", "b", "difference_percent"}]}. All figures are
/// listed, of inputs and placement those that differ. Throws Error for results of different kinds.
Json compare(const Result& a, const Result& b);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_DIFF_H
