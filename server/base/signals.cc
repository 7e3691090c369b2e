#include "server/base/signals.h"

namespace handrail {
namespace {

void mask_endings(int how) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : ending_signals()) sigaddset(&set, signal);
  pthread_sigmask(how, &set, nullptr);
}

}  // namespace

std::vector<int> ending_signals() {
  std::vector<int> out{SIGINT, SIGTERM};
  struct sigaction hang_up {};
  const bool known = ::sigaction(SIGHUP, nullptr, &hang_up) == 0;
  if (!known || hang_up.sa_handler != SIG_IGN) out.push_back(SIGHUP);
  return out;
}

void hold_endings() { mask_endings(SIG_BLOCK); }
void take_endings() { mask_endings(SIG_UNBLOCK); }

}  // namespace handrail
