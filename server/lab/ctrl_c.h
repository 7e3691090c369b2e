// Ctrl-C in the lab's commands.
#pragma once

#include <signal.h>

#include <atomic>

#include "server/base/signals.h"

namespace handrail {

// Raised by Ctrl-C: long work ends soon, and nothing half-done is printed. A second one ends the
// program at once.
inline std::atomic<bool>& ctrl_c() noexcept {
  static constinit std::atomic<bool> raised = false;  // no guard: a handler calls this
  return raised;
}

inline void let_ctrl_c_cancel() {
  struct sigaction action {};
  action.sa_handler = [](int) { ctrl_c() = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : ending_signals()) ::sigaction(signal, &action, nullptr);
}

}  // namespace handrail
