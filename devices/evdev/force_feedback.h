// The motors of an input device, through the kernel.
#pragma once

#include <atomic>
#include <memory>
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
  FeedbackThread(Nanos period, int priority) : period_(period), priority_(priority) {}
  ~FeedbackThread() { stop(); }
  FeedbackThread(const FeedbackThread&) = delete;
  FeedbackThread& operator=(const FeedbackThread&) = delete;

  // The thread keeps `work` until it has ended; the kernel behind it lives longer.
  void start(std::shared_ptr<FeedbackWork> work);
  // From here on at the device of that path; empty: at none. Real-time safe.
  void use(const FixedText<256>& path) noexcept {
    if (turns_) turns_->path.publish(path);
  }
  // Waits for the turn that runs, for kEndPatience: a call that the kernel holds up for longer is
  // left to itself, and what ends the work then comes after it. Twice is fine.
  void stop() noexcept;
  // Such threads of this program that use a kernel, those among them that were left to themselves.
  static int running() noexcept { return running_.load(std::memory_order_acquire); }

 private:
  struct Turns {
    std::shared_ptr<FeedbackWork> work;
    Nanos period;
    int priority;
    Mailbox<FixedText<256>> path;
    std::atomic<bool> stopping{false}, ended{false};
  };
  static inline std::atomic<int> running_{0};
  static void run(Turns& turns) noexcept;

  Nanos period_;
  int priority_;
  std::shared_ptr<Turns> turns_;
  std::thread thread_;
};

}  // namespace handrail
