// Which of the targets sent to the controller it may hold.
//
// A lost command and a lost reply look alike until the next reply. So a target is only good if it
// is one rated step, at most, from every target the controller may hold: the last one it has
// confirmed and all that were sent since. No loss then makes the controller see a step that it
// cannot make.
#pragma once

#include <array>

#include "server/base/deletable.h"
#include "server/base/joints.h"

namespace handrail {

// Of targets in a row that are alike only one is kept. Real-time safe.
class CommandTrain {
 public:
  // The controller holds `q`, and nothing else is on its way [rad].
  void restart(const JointVector& q) noexcept {
    sent_[0] = q;
    size_ = 1;
  }

  // `q` is sent.
  void add(const JointVector& q) noexcept {
    if (q == newest()) return;
    if (full()) return;  // may_send() has refused it
    sent_[size_++] = q;
  }

  // The controller says it holds `q`, rounded on its way by less than `kRounding`. What was sent
  // before that is over. False: it holds nothing that was sent, by more than `step`.
  bool confirm(const JointVector& q, const JointVector& step) noexcept {
    std::size_t best = 0;
    double least = distance(0, q);
    for (std::size_t i = 1; i < size_; ++i) {
      const double d = distance(i, q);
      if (d > least + kRounding) continue;
      best = i;
      least = d < least ? d : least;
    }
    if (((sent_[best] - q).cwiseAbs().array() > step.array()).any()) return false;
    drop(best);
    return true;
  }

  // Whether `q` is what the controller has last said it holds, but for that rounding.
  bool confirms(const JointVector& q) const noexcept { return distance(0, q) < kRounding; }

  // Whether `q` is within `step` of all that the controller may hold [rad].
  bool may_send(const JointVector& q, const JointVector& step) const noexcept {
    if (full() && q != newest()) return false;
    if (!kept(Check::kReach)) return true;
    for (std::size_t i = 0; i < size_; ++i) {
      if (((q - sent_[i]).cwiseAbs().array() > step.array()).any()) return false;
    }
    return true;
  }

  const JointVector& newest() const noexcept { return sent_[size_ - 1]; }
  // What the controller has last said it holds, exactly as it was sent.
  const JointVector& confirmed() const noexcept { return sent_[0]; }
  // How many targets were sent after the one the controller has confirmed.
  std::size_t unconfirmed() const noexcept { return size_ - 1; }

 private:
  static constexpr double kRounding = 1e-6;  // [rad]; of 32-bit numbers up to 4, twice
  // The last one confirmed, and what is sent in the 0.1 s that the slowest arm lags that counts as
  // following (FollowingSettings): for longer an arm that is held has stood, and the next target,
  // however near, would be a step from rest.
  static constexpr std::size_t kCapacity = 15;

  bool full() const noexcept { return size_ == kCapacity; }
  double distance(std::size_t i, const JointVector& q) const noexcept {
    return (sent_[i] - q).cwiseAbs().maxCoeff();
  }
  void drop(std::size_t count) noexcept {
    for (std::size_t i = count; i < size_; ++i) sent_[i - count] = sent_[i];
    size_ -= count;
  }

  std::array<JointVector, kCapacity> sent_{};
  std::size_t size_ = 1;
};

}  // namespace handrail
