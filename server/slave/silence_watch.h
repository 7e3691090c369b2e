// Why the robot controller does not answer, as its own switches tell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "devices/melfa/r3_switches.h"
#include "server/base/time.h"
#include "server/model/reason.h"
#include "server/slave/connection_watch.h"

namespace handrail {

// Asks while the controller is silent, and says each answer that is another than the last.
class SilenceWatch {
 public:
  // What keeps the controller from answering, or why its switches cannot be asked. Must not wait:
  // gives nothing until it is known; asked again until then.
  using Ask = std::function<std::optional<Obstacle>()>;
  // Between two questions: a person at the switches sees what was changed within a breath, and the
  // controller's command port is free for others nearly always. Our choice.
  static constexpr Nanos kPause = 5 * kSecond;

  // `ask` may be empty: nobody is asked. `name`: of the robot, in what is said.
  SilenceWatch(std::string name, Ask ask) : name_(std::move(name)), ask_(std::move(ask)) {}

  // `silent`: it was called and does not answer. Allocates when there is something to say.
  std::optional<ConnectionWatch::Line> step(Nanos now, bool silent) {
    if (!silent) {
      reason_ = Reason::kNone;
      said_.clear();
    }
    // What was asked before it answered is no news any more.
    if (!ask_ || (!silent && !asking_) || (!asking_ && now < next_)) return std::nullopt;
    if (!std::exchange(asking_, true)) of_this_silence_ = true;
    of_this_silence_ = of_this_silence_ && silent;
    const std::optional<Obstacle> why = ask_();
    if (!why) return std::nullopt;
    asking_ = false;
    next_ = now + kPause;
    if (!of_this_silence_) return std::nullopt;
    reason_ = why->reason;
    const std::string text = name_ + " is silent: " + why->fact + "; " + why->next;
    if (text == said_) return std::nullopt;
    said_ = text;
    return ConnectionWatch::Line{true, text};
  }

  // The last answer's; kNone: it answers, or nothing is known.
  Reason reason() const noexcept { return reason_; }

 private:
  std::string name_;
  Ask ask_;
  std::string said_;
  Reason reason_ = Reason::kNone;
  bool asking_ = false, of_this_silence_ = false;
  Nanos next_ = -kForever;
};

}  // namespace handrail
