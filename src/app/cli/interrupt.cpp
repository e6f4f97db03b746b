#include "app/cli/interrupt.h"

#include <csignal>

namespace parian {
namespace {

volatile std::sig_atomic_t interrupted = 0;

// A second signal ends the program at once.
void set_interrupted(int signal) {
  interrupted = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, set_interrupted);
  std::signal(SIGTERM, set_interrupted);
}

bool was_interrupted() {
  return interrupted != 0;
}

}  // namespace parian
