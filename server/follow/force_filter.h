// A low pass for the contact force.
#pragma once

#include "server/base/spatial.h"

namespace handrail {

// First order. It begins with the first force and is then late by its lag, whatever the cycle.
// Real-time safe.
class ForceFilter {
 public:
  // The next sound reading `f` [N]; `lag` >= 0: how much later a steady rise is seen [s], 0 passes
  // every bit; `dt` > 0: cycle [s].
  const Vec3& pass(const Vec3& f, double lag, double dt) noexcept {
    if (running_ && lag > 0.0) {
      value_ += dt / (lag + dt) * (f - value_);
    } else {
      value_ = f;
    }
    running_ = true;
    return value_;
  }
  // The sensor is lost: the next reading is a first one.
  void restart() noexcept { running_ = false; }

 private:
  Vec3 value_ = Vec3::Zero();
  bool running_ = false;
};

}  // namespace handrail
