// Signals that ask a run to stop at the next checkpoint.
#pragma once

namespace sandglass {

/// From now on SIGINT, SIGTERM and SIGUSR1 only set a flag; a second SIGINT ends the program at once.
void catch_stop_signals();

/// Whether one of them has come.
bool stop_signal_came();

}  // namespace sandglass
