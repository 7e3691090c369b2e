#include "client/cli/interrupt.h"

#include <signal.h>
#include <stdio_ext.h>

#include <atomic>
#include <cstdio>

#include "server/base/signals.h"

namespace handrail {
namespace {

std::atomic<bool> came{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

}  // namespace

void catch_interrupts() {
  came = false;
  struct sigaction action {};
  action.sa_handler = [](int) { came = true; };
  for (const int signal : ending_signals()) ::sigaction(signal, &action, nullptr);
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &action, nullptr);
}

bool interrupted() { return came; }

void drop_output() {
  ::__fpurge(stdout);
  std::clearerr(stdout);
}

}  // namespace handrail
