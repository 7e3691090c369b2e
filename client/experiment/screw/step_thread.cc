#include "client/experiment/screw/step_thread.h"

#include <utility>

namespace handrail {

StepThread::StepThread(std::function<void(StepThread&)> procedure)
    : thread_([this, procedure = std::move(procedure)] {
        go_.acquire();
        if (!ends_) procedure(*this);
        ended_ = true;
        paused_.release();
      }) {}

StepThread::~StepThread() {
  ends_ = true;
  go_.release();
  thread_.join();
}

void StepThread::resume() {
  if (ended_) return;
  go_.release();
  paused_.acquire();
}

bool StepThread::pause() {
  if (ends_) return false;
  paused_.release();
  go_.acquire();
  return !ends_;
}

}  // namespace handrail
