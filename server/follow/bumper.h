// Virtual bumper (dissertation 3.2.3): Algorithm 3 as published, and a default law that keeps what
// it is for in stiff contact, under friction, noise and delay.
//
// The default law latches a contact where it was first felt. It measures the contact's stiffness k
// and advances into it no faster than the force that is left below the threshold allows for k and
// for the delay of the arm, and not at all where that is no more than noise; above the threshold
// the command only goes where no surface of the given friction that could push so is gone into. The
// normal is one direction of the friction cone around the force, and turns only when the force
// leaves that cone: friction does not tilt it. The contact ends where its surface is left behind,
// whatever is commanded.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/spatial.h"
#include "server/model/bumper_settings.h"
#include "server/model/reason.h"

namespace handrail {

// One cycle. All finite, positions within 1 km, forces within 1 MN.
struct BumperInput {
  Vec3 p_SU = Vec3::Zero();    // the command, on its tool [m]
  Vec3 f_E_S = Vec3::Zero();   // force of the environment on the tip [N]
  bool fresh = true;           // false: the force is an older one, the newest reading was bad
  Vec3 p_last = Vec3::Zero();  // where the tip comes to rest by the commands so far [m]
  Vec3 p_ST = Vec3::Zero();    // measured tip [m]
  double delay = 0.0;  // from a command to the force that it made, beside the cycle itself [s]
  double dt = 0.0071;  // cycle [s]
};

struct Bumped {
  Vec3 p_SB = Vec3::Zero();  // the command to follow [m]
  // kBumper: held back from a contact. kApproach: slower than commanded, for the promised force.
  // kNone: followed, but for what it yields to a force.
  Reason why = Reason::kNone;
};

// What the default law remembers.
struct BumperState {
  enum class Phase : std::uint8_t { kFree, kTouching, kReturning };
  static constexpr int kTips = 16;  // cycles of the largest sensor lag

  Phase phase = Phase::kFree;
  bool doubtful = false;           // it was first felt on a way out: is it the surface's?
  Vec3 n_S = Vec3::UnitZ();        // out of the surface, within the friction cone of the force
  double stiffness = 0.0;          // felt so far [N/m]
  double give = 0.0;               // how far the command yields along n_S [m]
  Vec3 p_touch = Vec3::Zero();     // the last place without contact [m]
  Vec3 p_felt = Vec3::Zero();      // the last place where it was felt above `contact` [m]
  double apart = 1e9;              // since the last contact [s]
  int felt = 0;                    // readings in a row above `contact`
  double last_normal_force = 0.0;  // of the cycle before [N]
  Vec3 last_tip = Vec3::Zero();    // where it was measured [m]
  Vec3 followed = Vec3::Zero();    // the cycle before [m]
  Vec3 behind = Vec3::Zero();      // from the command to it, but for the promise [m]
  std::array<Vec3, kTips> tips{};  // the newest measured ones, a ring [m]
  int newest = -1;

  bool touching() const noexcept { return phase == Phase::kTouching; }
  // Where the tip was measured `lag` ago, of cycles of `dt` [m]; one cycle at least has passed.
  const Vec3& tip_before(double lag, double dt) const noexcept;
};

// One cycle of the form set. Real-time safe, 0.1 us.
Bumped bump(const BumperSettings& settings, const BumperInput& in, BumperState& state) noexcept;

// Algorithm 3 with (3.10). Moving away from the contact is always free; a pure push into it above
// the threshold returns `p_last`. The published step backs off by |d| - |d_n| on a slanting push.
Bumped bump_as_published(const BumperSettings& settings, const Vec3& p_SU, const Vec3& f_E_S,
                         const Vec3& p_last) noexcept;

// The fastest approach that keeps a first contact of the stiffest kind below `promise`: a force of
// `room` [N] above the threshold after `delay` and the way the arm needs to brake [m/s]. Mostly the
// law brakes before the threshold, from the third reading above `contact` on: what that spares, a
// fifth to a third of the promise, is left to arms that brake worse or later than was measured.
double approach_speed(const BumperSettings& settings, double room, double delay,
                      double dt) noexcept;

}  // namespace handrail
