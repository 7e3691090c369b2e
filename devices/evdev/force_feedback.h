// The motors of an input device, through the kernel.
#pragma once

#include <atomic>
#include <thread>

#include "devices/evdev/evdev_file.h"
#include "server/base/mailbox.h"
#include "server/base/time.h"

namespace handrail {

// Effects that are uploaded, changed, played and erased. Each call may wait for the device, so none
// is for a real-time thread. Calls without a device that is open do nothing.
//
// Source: Linux, Documentation/input/ff.rst and include/uapi/linux/input.h.
class ForceFeedback {
 public:
  explicit ForceFeedback(EvdevKernel& kernel) : kernel_(kernel) {}
  ~ForceFeedback() { close(); }
  ForceFeedback(const ForceFeedback&) = delete;
  ForceFeedback& operator=(const ForceFeedback&) = delete;

  // False where the device may not be written to. Closes what was open.
  bool open(const char* path) noexcept;
  bool is_open() const noexcept { return fd_ >= 0; }
  // Creates the effect where its id is -1, which gives it one, and else changes it. False: the
  // device did not take it; errno says why.
  bool upload(ff_effect& effect) noexcept;
  // One that was not uploaded is not played. False: the device is gone.
  bool play(const ff_effect& effect, bool on) noexcept;
  // FF_GAIN or FF_AUTOCENTER, 0 to 0xFFFF. A device that has none ignores it.
  void set(int code, int value) noexcept { (void)write(code, value); }
  // Gives back its slot.
  void erase(ff_effect& effect) noexcept;
  // The kernel forgets all effects.
  void close() noexcept;

 private:
  bool write(int code, int value) noexcept;

  EvdevKernel& kernel_;
  int fd_ = -1;
};

// What a thread that may wait for a device does there.
class FeedbackWork {
 public:
  virtual ~FeedbackWork() = default;
  // The device of that path; empty: none.
  virtual void use(const FixedText<256>& path) noexcept = 0;
  // `now`: as it begins.
  virtual void turn(Nanos now) noexcept = 0;
  virtual void end() noexcept = 0;
};

// The thread.
class FeedbackThread {
 public:
  // `priority`: of real time; 0: behind all that is not told otherwise.
  FeedbackThread(FeedbackWork& work, Nanos period, int priority)
      : work_(work), period_(period), priority_(priority) {}
  ~FeedbackThread() { stop(); }
  FeedbackThread(const FeedbackThread&) = delete;
  FeedbackThread& operator=(const FeedbackThread&) = delete;

  void start();
  // From here on at the device of that path; empty: at none. Real-time safe.
  void use(const FixedText<256>& path) noexcept { path_.publish(path); }
  // Waits for the turn that runs. Twice is fine.
  void stop() noexcept;

 private:
  void run() noexcept;

  FeedbackWork& work_;
  Nanos period_;
  int priority_;
  Mailbox<FixedText<256>> path_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last: it uses the others
};

}  // namespace handrail
