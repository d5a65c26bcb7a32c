// The parts of `partita bench` that have files of their own.
#ifndef PARTITA_HOST_APP_BENCH_H
#define PARTITA_HOST_APP_BENCH_H

#include <string>

#include "host/app/command.h"

namespace partita::app {

void add_bench_peers(CLI::App& bench, Context& context);
void add_bench_detect(CLI::App& bench, Context& context);
void add_bench_simulate(CLI::App& bench, Context& context);

/// "AMD EPYC 7763 64-Core Processor"; empty where the system does not say.
std::string processor();

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_BENCH_H
