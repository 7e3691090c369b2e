// What the link's two ages and its quality allow.
#pragma once

#include "server/model/link_state.h"
#include "server/session/link_window.h"
#include "server/session/session.h"

namespace handrail {

// What an engagement asks of the link, both ways over the window of LadderSettings, which must have
// been heard all along: without a gap of over 200 ms.
// Half of what a gap of 200 ms, which ends an engagement, holds in a second: (200 - 20) / 2 ms.
inline constexpr double kMostHeld = 0.09;
// What GOOD allows.
inline constexpr double kMostLost = 0.25;

// Constant while a scene is loaded.
struct LadderSettings {
  Nanos good_for = 0;  // the window; 0: nothing is asked but that the link is fresh
  Nanos warn_loop = 100 * kMillisecond;  // an older loop is said
  Nanos fade_loop = kForever;            // an older one takes the force away; the arm goes on
};

struct LadderState {
  LinkWindow window;
};

struct LadderStep {
  LinkRung rung = LinkRung::kNone;
  LinkShares shares;       // over the window
  bool good = false;       // enough to engage over
  bool old_loop = false;   // over `warn_loop`
  double force_share = 1;  // 0 to 1
};

// The rung of `age` [ns], but hold where either direction is POOR. Real-time safe.
LinkRung rung_of(bool ever, Nanos age, const LinkView& link) noexcept;

// `share` is more than the `most` that is asked, beyond what sums round. Real-time safe.
constexpr bool too_much(double share, double most) noexcept { return share > most + 1e-9; }

// Heard all along, and within kMostHeld and kMostLost. Real-time safe.
bool good_enough(const LinkShares& shares) noexcept;

// One tick; `elapsed`: since the last [s]. The age of the newest datagram decides the rung; the
// loop's age only warns and fades the force over a tenth of a second beyond its limit, and never
// latches: constant delay stays drivable. A gap of over 200 ms either way begins the window anew.
// Real-time safe.
LadderStep ladder_step(const LadderSettings& settings, bool ever, Nanos age, const LinkView& link,
                       double elapsed, LadderState& state) noexcept;

}  // namespace handrail
