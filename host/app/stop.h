// Ctrl-C and kill: the first asks for an orderly end after the current frame, the second ends at
// once.
#ifndef PARTITA_HOST_APP_STOP_H
#define PARTITA_HOST_APP_STOP_H

namespace partita::app {

/// From now on SIGINT and SIGTERM set stop_requested().
void catch_stop_signals();
bool stop_requested();

}  // namespace partita::app

#endif  // PARTITA_HOST_APP_STOP_H
