#include "sandglass/cmd/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace sandglass {
namespace {

volatile std::sig_atomic_t stop_signal = 0;

extern "C" void note_stop_signal(int signal) {
  if (signal == SIGINT && stop_signal == SIGINT) {
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
  stop_signal = signal;
}

}  // namespace

void catch_stop_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, note_stop_signal);
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the user's limit fails to be written, like one on a full disk
}

bool stop_signal_came() { return stop_signal != 0; }

}  // namespace sandglass
