#include "host/tasks/backend/problem.h"

#include <fmt/format.h>

#include "host/runtime/error.h"

namespace partita::backend {

std::string_view to_string(CameraModel model) {
  return model == CameraModel::bal ? "bal" : "stereo";
}

std::string_view to_string(Loss loss) {
  return loss == Loss::none ? "none" : loss == Loss::huber ? "huber" : "cauchy";
}

Loss parse_loss(std::string_view name) {
  for (const Loss loss : {Loss::none, Loss::huber, Loss::cauchy}) {
    if (to_string(loss) == name) return loss;
  }
  throw Error(fmt::format("'{}' is not a loss: expected none, huber or cauchy", name));
}

}  // namespace partita::backend
