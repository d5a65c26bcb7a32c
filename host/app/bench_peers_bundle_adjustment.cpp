// Bundle adjustment beside Ceres (Agarwal, Mierle et al.), on a problem of Bundle Adjustment in the
// Large, to the same tolerance.
#include <fmt/format.h>

#include "host/app/bal_problem.h"
#include "host/app/bench_peers.h"
#include "host/app/environment.h"
#include "host/runtime/session.h"
#include "host/tasks/backend/ceres_solver.h"
#include "host/tasks/backend/solver.h"

namespace partita::app {
namespace {

Contestant judged(Contestant contestant, const backend::Summary& summary) {
  contestant.quality = {{"final_cost", summary.final_cost}, {"iterations", summary.steps()}};
  contestant.quality_text = fmt::format("cost {:.6e} to {:.6e} in {} iterations",
                                        summary.initial_cost, summary.final_cost, summary.steps());
  return contestant;
}

}  // namespace

PeerComparison compare_bundle_adjustment(const PeerOptions& options, const RoundDone& done) {
  const backend::Problem start = to_problem(io::read_bal(options.problem));
  set_emulation({.machine = kNativeMachine});
  const runtime::Device device = runtime::select_device(runtime::find_devices(), "cpu");
  const runtime::Session session(device,
                                 backend::kernels(start.model, backend::Precision::full).list(),
                                 {.variant = runtime::Variant::cpu});
  const backend::BundleAdjuster adjuster(session, start.model);
  const backend::SolverOptions solving;
  const auto threads = static_cast<int>(options.cores);

  backend::Summary ours, ceres;
  const std::vector<std::function<void()>> contestants{[&] {
                                                         backend::Problem problem = start;
                                                         ours = adjuster.solve(problem, solving);
                                                       },
                                                       [&] {
                                                         backend::Problem problem = start;
                                                         ceres = backend::solve_with_ceres(
                                                             problem, solving, threads);
                                                       }};
  const auto ms = time_in_turns(contestants, options.rounds, done);

  PeerComparison comparison{
      .task = "bundle-adjustment",
      .input = fmt::format("{}: {} cameras, {} points, {} observations", options.problem,
                           start.cameras.size(), start.points.size(), start.observations.size()),
      .timed =
          "from the problem in host memory to the adjusted one, all set-up included but the "
          "loading of kernels"};
  comparison.ours = judged(
      {"partita bundle-adjust",
       fmt::format("CPU variant on {}, double precision, {}", device.name, ours.linear_solver),
       ms[0]},
      ours);
  comparison.peers = {
      judged({"Ceres",
              fmt::format("{}, {} threads, automatic derivatives, function tolerance {:g}",
                          ceres.linear_solver, threads, solving.function_tolerance),
              ms[1]},
             ceres)};
  return comparison;
}

}  // namespace partita::app
