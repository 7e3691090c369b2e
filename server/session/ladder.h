// What the link's two ages and its quality allow.
#pragma once

#include "server/model/link_state.h"
#include "server/session/session.h"

namespace handrail {

// Constant while a scene is loaded.
struct LadderSettings {
  Nanos good_for = 0;  // the link is GOOD both ways for so long before an engagement
  Nanos warn_loop = 100 * kMillisecond;  // an older loop is said
  Nanos fade_loop = kForever;            // an older one takes the force away; the arm goes on
};

struct LadderState {
  double good = 0.0;  // how long the link has been GOOD both ways, at most 100 [s]
};

struct LadderStep {
  LinkRung rung = LinkRung::kNone;
  bool held_good = false;  // for `good_for`
  bool old_loop = false;   // over `warn_loop`
  double force_share = 1;  // 0 to 1
};

// The rung of `age` [ns], but hold where either direction is POOR. Real-time safe.
LinkRung rung_of(bool ever, Nanos age, const LinkView& link) noexcept;

// One tick of `dt` [s]. The age of the newest datagram decides the rung; the loop's age only warns
// and fades the force over a tenth of a second beyond its limit, and never latches: constant delay
// stays drivable. Real-time safe.
LadderStep ladder_step(const LadderSettings& settings, bool ever, Nanos age, const LinkView& link,
                       double dt, LadderState& state) noexcept;

}  // namespace handrail
