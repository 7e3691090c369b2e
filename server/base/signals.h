// Signals: those that end a program, and threads that leave them to others.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <vector>

namespace handrail {

// SIGINT and SIGTERM, and SIGHUP for a terminal that was closed, unless that is ignored: it is for
// who was started by nohup.
std::vector<int> ending_signals();

// From here on they wait until take_endings(): what drives the arm is started in between, and must
// not be killed for want of somebody who hears them. In the thread that starts the others.
void hold_endings();
// Those that came meanwhile come now, in this thread.
void take_endings();

// A thread started while it lives never gets a signal, not even before its first step.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

}  // namespace handrail
