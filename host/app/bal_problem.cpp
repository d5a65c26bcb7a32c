#include "host/app/bal_problem.h"

namespace partita::app {

backend::Problem to_problem(const io::BalProblem& bal) {
  backend::Problem problem;
  problem.cameras = bal.cameras;
  problem.points = bal.points;
  problem.observations.reserve(bal.observations.size());
  for (const io::BalObservation& o : bal.observations) {
    problem.observations.push_back(
        {.camera = o.camera, .point = o.point, .measured = {o.x, o.y, 0}});
  }
  return problem;
}

}  // namespace partita::app
