// Association on the device: left with right along the rows, and one left image with a later one
// around predicted positions; both refined to a fraction of a pixel.
#ifndef PARTITA_HOST_TASKS_FRONTEND_ASSOCIATOR_H
#define PARTITA_HOST_TASKS_FRONTEND_ASSOCIATOR_H

#include <vector>

#include "host/runtime/kernel.h"
#include "host/tasks/frontend/extractor.h"
#include "host/tasks/frontend/shapes.h"

namespace partita::frontend {

class Associator {
 public:
  Associator(const runtime::Session& session, const Extractor& extractor,
             const FrontendParameters& parameters);

  /// For every left feature its place in the right image. Both directions have to agree.
  std::vector<RefinedMatch> stereo(const DeviceFeatures& left, const DeviceFeatures& right);
  /// For every feature of `from` its place in `to`, searched within the (wide) search window
  /// around its own plus its shift; of several that match one, the nearest descriptor counts.
  /// `searched` of the shifts are predictions.
  std::vector<RefinedMatch> temporal(const DeviceFeatures& from, const DeviceFeatures& to,
                                     const std::vector<Shift>& shifts, int searched, bool wide);

 private:
  void match(const DeviceFeatures& queries, const DeviceFeatures& trains, const cl::Buffer& shifts,
             const Window& window, int max_hamming, int ratio_q8, const cl::Buffer& matches,
             int searched);
  std::vector<RefinedMatch> refine(const DeviceFeatures& a, const DeviceFeatures& b,
                                   const SadRange& range, bool same_row);

  const runtime::Session& session_;
  const Extractor& extractor_;
  FrontendParameters parameters_;
  runtime::Kernel match_window_;
  runtime::Kernel invert_matches_;
  runtime::Kernel refine_sad_;
  cl::Buffer no_shifts_;
  cl::Buffer shifts_;
  cl::Buffer forward_;
  cl::Buffer backward_;
  cl::Buffer refined_;
};

}  // namespace partita::frontend

#endif  // PARTITA_HOST_TASKS_FRONTEND_ASSOCIATOR_H
