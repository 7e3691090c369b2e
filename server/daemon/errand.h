// What may wait for a disk or a terminal, done aside.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>
#include <utility>

#include "server/base/signals.h"
#include "server/base/status.h"

namespace handrail {

// Whether an errand was still under way when its owner was gone. It may use whatever static objects
// it likes, so the process must then end without destroying them (run_daemon() sees to it).
inline std::atomic<bool> errand_left_behind{false};

// One task at a time in a thread of its own, with ordinary priority. Nobody waits for it: not its
// owner, not the owner's end. T: Status, or a Result. For one thread. Takes no lock.
template <typename T>
class Errand {
 public:
  // Throws std::system_error where no thread can be had.
  Errand() {
    const SignalsBlocked blocked;
    thread_ = std::thread([state = state_] { serve(*state); });
  }
  ~Errand() {
    state_->wake.release();
    if (state_->step.load() != Step::kUnderWay) {
      thread_.join();
    } else {
      errand_left_behind.store(true);
      thread_.detach();
    }
  }
  Errand(const Errand&) = delete;
  Errand& operator=(const Errand&) = delete;

  // Begins `work` and gives its result, once, at a later call, when it is there; `work` counts only
  // when nothing is under way. It must own all that it uses. Without memory the result is an error.
  std::optional<T> poll(const std::function<T()>& work) {
    State& state = *state_;
    switch (state.step.load(std::memory_order_acquire)) {
      case Step::kUnderWay: return std::nullopt;
      case Step::kDone:
        state.step.store(Step::kIdle, std::memory_order_relaxed);
        return std::exchange(state.result, std::nullopt);
      case Step::kIdle: break;
    }
    state.work = work;
    state.step.store(Step::kUnderWay, std::memory_order_relaxed);
    state.wake.release();
    return std::nullopt;
  }

 private:
  enum class Step { kIdle, kUnderWay, kDone };
  struct State {
    std::counting_semaphore<> wake{0};  // for work, and once for the end
    std::atomic<Step> step{Step::kIdle};
    std::function<T()> work;
    std::optional<T> result;
  };

  static void serve(State& state) {
    for (;;) {
      state.wake.acquire();
      if (state.step.load() != Step::kUnderWay) return;  // its owner is gone
      try {
        state.result.emplace(std::exchange(state.work, nullptr)());
      } catch (const std::bad_alloc&) {
        state.result.emplace(Status::error("no memory left"));  // short: it takes none
      } catch (const std::exception& refused) {
        state.result.emplace(Status::error(std::string("cannot be done now: ") + refused.what()));
      }
      state.step.store(Step::kDone, std::memory_order_release);
    }
  }

  std::shared_ptr<State> state_ = std::make_shared<State>();
  std::thread thread_;
};

}  // namespace handrail
