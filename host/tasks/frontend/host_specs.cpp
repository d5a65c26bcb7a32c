// Work of the front-end's host steps, in double precision.
#include "host/tasks/frontend/kernels.h"

namespace partita::frontend {

using runtime::HostSpec;
using runtime::Shape;

const HostSpec& motion_spec() {
  static const HostSpec spec{
      "motion", "frontend", [](const Shape& shape) {
        const auto matches = static_cast<std::uint64_t>(shape["matches"]);
        const auto hypotheses = static_cast<std::uint64_t>(shape["hypotheses"]);
        const auto inliers = static_cast<std::uint64_t>(shape["inliers"]);
        const auto iterations = static_cast<std::uint64_t>(shape["iterations"]);
        // A projection: 3 x 3 product, translation, perspective. A hypothesis: about five steps of
        // three points with their 2 x 6 Jacobians and a 6 x 6 factorisation, then a projection of
        // every match. An iteration: residuals and automatic derivatives of every inlier, then QR.
        const std::uint64_t projections = hypotheses * (matches + 15);
        Work work;
        work.kind = WorkKind::serial;
        work[OpClass::double_fma] = 9 * projections + hypotheses * 5 * (3 * 60 + 90) +
                                    iterations * inliers * (2 * 6 * 12 + 2 * 6 * 6 * 2);
        work[OpClass::double_add] = 8 * projections + iterations * inliers * 40;
        work[OpClass::double_special] = 3 * projections + iterations * inliers * 4;
        work.read_issued = 40 * projections + iterations * inliers * (40 + 2 * 7 * 8);
        work.read_unique = 40 * matches;
        work.written_issued = work.written_unique = matches;
        return work;
      }};
  return spec;
}

const HostSpec& predict_spec() {
  static const HostSpec spec{"predict", "frontend", [](const Shape& shape) {
                               const auto keypoints =
                                   static_cast<std::uint64_t>(shape["keypoints"]);
                               Work work;
                               work.kind = WorkKind::serial;
                               work[OpClass::double_fma] = 11 * keypoints;
                               work[OpClass::double_add] = 8 * keypoints;
                               work[OpClass::double_mul] = 4 * keypoints;
                               work[OpClass::double_special] = 3 * keypoints;
                               work.read_issued = work.read_unique = 32 * keypoints;
                               work.written_issued = work.written_unique = 8 * keypoints;
                               return work;
                             }};
  return spec;
}

std::vector<const HostSpec*> host_specs() {
  return {&motion_spec(), &predict_spec()};
}

}  // namespace partita::frontend
