// A procedure that pauses in the middle, until it is let go on.
#pragma once

#include <functional>
#include <semaphore>
#include <thread>

namespace handrail {

// It has a thread of its own, but runs only while resume() waits for it: what both use needs no
// lock.
class StepThread {
 public:
  // Does not begin before the first resume().
  explicit StepThread(std::function<void(StepThread&)> procedure);
  // A procedure that pauses is told to end, and has to.
  ~StepThread();
  StepThread(const StepThread&) = delete;
  StepThread& operator=(const StepThread&) = delete;

  // Until it pauses or has ended.
  void resume();
  // In the procedure: false: it is to end.
  bool pause();

 private:
  std::binary_semaphore go_{0}, paused_{0};
  bool ends_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace handrail
