// What is common to the comparisons of `partita bench peers`: a task of ours beside a library that
// does the same, on the same inputs and cores, in turns. Each comparison has a file of its own,
// bench_peers_*.cpp, and one line in bench_peers.cpp.
#ifndef PARTITA_HOST_APP_BENCH_PEERS_H
#define PARTITA_HOST_APP_BENCH_PEERS_H

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/app/console.h"
#include "host/tasks/sensing/frame.h"

namespace partita::app {

struct PeerOptions {
  int rounds = 15;          ///< at least 1
  unsigned cores = 1;       ///< that either side may use
  std::string left, right;  ///< a stereo pair to use; empty: the built-in scenario's first
  std::string networks;     ///< folder of Darknet networks; empty: there is none
  std::string problem;      ///< file in the format of BAL; empty: there is none
};

struct PeerPair {
  std::string name;  ///< "first frame of scenario (seed 1), 1280x720"
  sensing::GrayImage left, right;
  std::optional<sensing::FloatImage> truth;  ///< disparities
};

/// The pair that the options name.
PeerPair peer_pair(const PeerOptions& options);

/// One who does the task, ours or a peer.
struct Contestant {
  std::string name;        ///< "cv::StereoSGBM"
  std::string parameters;  ///< on one line
  std::vector<double> ms;  ///< wall time of each round
  /// Of what came out, where the truth is known: for scripts and for people.
  Json quality = {};
  std::string quality_text = "-";
};

/// Ours against each of the others.
struct PeerComparison {
  std::string task;   ///< "depth"
  std::string input;  ///< "1280x720, scenario, seed 1"
  std::string timed;  ///< what is in the time: "pictures to map, both in host memory"
  Contestant ours;
  std::vector<Contestant> peers;
};

/// Called after each round.
using RoundDone = std::function<void()>;

/// Runs all of them once to warm up, then `rounds` times in turns, so that a change of the
/// machine's load meets every one; for each, the milliseconds of its rounds.
std::vector<std::vector<double>> time_in_turns(std::span<const std::function<void()>> contestants,
                                               int rounds, const RoundDone& done);

PeerComparison compare_depth(const PeerOptions& options, const RoundDone& done);
PeerComparison compare_features(const PeerOptions& options, const RoundDone& done);
/// With PeerOptions::problem.
PeerComparison compare_bundle_adjustment(const PeerOptions& options, const RoundDone& done);
PeerComparison compare_street(const PeerOptions& options, const RoundDone& done);
// With networks of PeerOptions::networks.
PeerComparison compare_yolo_fastest(const PeerOptions& options, const RoundDone& done);
PeerComparison compare_yolo_fastest_xl(const PeerOptions& options, const RoundDone& done);
PeerComparison compare_yolov3_tiny(const PeerOptions& options, const RoundDone& done);
PeerComparison compare_yolov3(const PeerOptions& options, const RoundDone& done);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_BENCH_PEERS_H
