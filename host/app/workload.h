// Binds the tasks' exported programs to the partitioner's Workload. No OpenCL call is made: what a
// pipeline costs can be asked on a computer that has no OpenCL device at all.
#ifndef PARTITA_HOST_APP_WORKLOAD_H
#define PARTITA_HOST_APP_WORKLOAD_H

#include <string>

#include "host/app/run_counts.h"
#include "host/tasks/program.h"
#include "partition/graph/pipeline.h"
#include "partition/graph/workload.h"

namespace partita::app {

/// Every frame alike, with counts that are typical for the pipeline's pictures. Throws Error for a
/// task of the pipeline that nobody exports, which lists those there are.
partition::Workload typical_workload(const partition::Pipeline& pipeline);

/// The frames of an earlier run, one after the other; tasks that the run had not repeat their
/// typical frame. Throws Error as well if the run's pictures are not of the pipeline's size.
partition::Workload recorded_workload(const partition::Pipeline& pipeline, const RunCounts& run);
/// The same from the run's output folder.
partition::Workload recorded_workload(const partition::Pipeline& pipeline,
                                      const std::string& folder);

/// One task; every distinct Work is kept once.
partition::TaskWork to_work(const tasks::TaskExport& task);

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_WORKLOAD_H
