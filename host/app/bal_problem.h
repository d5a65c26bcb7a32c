// From a file of Bundle Adjustment in the Large to a problem of the back-end.
#ifndef PARTITA_HOST_APP_BAL_PROBLEM_H
#define PARTITA_HOST_APP_BAL_PROBLEM_H

#include "host/io/bal.h"
#include "host/tasks/backend/problem.h"

namespace partita::app {

backend::Problem to_problem(const io::BalProblem& bal);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_BAL_PROBLEM_H
