// Keeps what is rendered at the hand from making energy.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "server/base/spatial.h"

namespace handrail {

// What the device takes up by itself. All >= 0. Of turning it, here and below, the same in kg m^2,
// N m and rad.
struct GovernorSettings {
  bool on = false;
  double friction = 0.0;   // of the device, Coulomb [N]
  double damping = 0.0;    // of the device, viscous [N s/m]
  double peak = 3.3;       // largest force that the device makes [N]
  double period = 1e-3;    // of the loop, nominal, > 0 [s]
  double most_way = 0.05;  // a hand further away than this after a tick has jumped [m]
  int delay = 0;           // from a force to its acting on the device, 0 to kMostForceDelay [ticks]
  double late = 0.0;       // and so much of a tick beside, 0 <= late < 1
};

// Longer than any device's own way from a position to a force that we know of (links are not among
// them: their springs are bounded).
inline constexpr int kMostForceDelay = 31;

inline constexpr double kNoForceLimit = std::numeric_limits<double>::infinity();  // [N]

// The force that is asked for, by what makes it. Frame M.
struct RenderedForce {
  Vec3 wanted = Vec3::Zero();   // in all [N]
  Vec3 springs = Vec3::Zero();  // of it, what springs give: what they took comes back [N]
  double stiffness = 0.0;       // of these springs together, the most it can be now [N/m]
};

// What a tick of the governor came to.
struct Governed {
  Vec3 force = Vec3::Zero();  // what was wanted or less, in its direction [N]
  double made = 0.0;          // energy that was made and not yet taken back, >= 0 [J]
  double used = 0.0;          // of what the device took in this tick, for what was made, >= 0 [J]
  bool acted = false;
};

// What the device was told, tick by tick, as long as some of it may be on its way [N].
class ToldForces {
 public:
  void add(const Vec3& force) noexcept;
  // The one that acted in the tick that has just passed; `delay` as in GovernorSettings.
  const Vec3& acting(int delay) const noexcept;
  // The mean of it, where for so much of the tick the one before did; `missed`: for all of it.
  Vec3 acting(const GovernorSettings& settings, bool missed) const noexcept;
  void clear() noexcept { told_.fill(Vec3::Zero()); }

 private:
  std::array<Vec3, kMostForceDelay + 1> told_ = zeros();
  std::size_t newest_ = 0;

  static std::array<Vec3, kMostForceDelay + 1> zeros() noexcept {
    std::array<Vec3, kMostForceDelay + 1> out;
    out.fill(Vec3::Zero());
    return out;
  }
};

// Where the hand goes, and what the device takes of it by itself, of a way that an encoder tells in
// counts: now of one axis and now of another, and in most ticks of a slow hand none.
class HandWay {
 public:
  // One tick, `dt` > 0 [s]. What the device took [J], the least that it can have been: the way
  // counts along where the hand went before, and a count as gone in all of the time since the last.
  // `used` of it is not there any more [J].
  double add(const GovernorSettings& settings, const Vec3& moved, double dt,
             double used = 0.0) noexcept;
  // Unit, the last counts together; none: it has not moved yet.
  const Vec3& along() const noexcept { return along_; }
  // The last [m], along that, > 0 where there is one, and what the device took of it [J].
  double last() const noexcept { return last_; }
  double taken() const noexcept { return taken_; }

 private:
  // Of a way when the next is added: both axes of a slanted way stay, and a hand that turns back
  // is seen to after two counts. Chosen.
  static constexpr double kKept = 0.5;

  Vec3 way_ = Vec3::Zero(), along_ = Vec3::Zero();
  double last_ = 0.0, taken_ = 0.0;
  double still_ = 0.0;  // since the last way [s]
};

// Observer and controller at the hand port, for forces that are held for a period.
//
// A spring that is held for a period pushes less on the way in, and more on the way out, than the
// spring of its law: each tick makes K dx^2 / 2. What was made in a tick is the work that the
// device did less the work of the law's springs on the same way, by the trapezoid between its ends;
// what a damper takes counts as taken, and what one makes as made. The device takes its own
// friction and damping of it. The rest is taken back when the hand is next pushed: the force is
// made smaller, by as much as this tick is about to make, and by what is left over, spread over the
// spring's way to its rest. It is never larger, and never turned: what a slanted way asked for
// alone would push the hand to the side, and one that counts hunted along a wall by 1 mm. A hand
// that presses or stands meets all of it.
//
// A spring that is touched, or left, within a tick is taken to begin or end on the way; one that
// the device's limits cut off gives no more than they let pass. Tools and walls that move do work
// that their reason pays for; only how the hand moves counts here.
class EnergyGovernor {
 public:
  // One tick. `moved`: of the hand since the last tick [M, m]; `dt` since then [s]. Values that are
  // not finite count as none; a jump of the hand, or of the clock, credits nothing. `missed`: what
  // was told last has not acted yet, what was told before went on. Real-time safe.
  Governed govern(const GovernorSettings& settings, const RenderedForce& force, const Vec3& moved,
                  double dt, bool missed = false) noexcept;
  // What the device was told of it in the end, within its limits; it acts until the next tick [N].
  void told(const Vec3& force) noexcept;
  // The hand is elsewhere, or is not heard: the way since the last tick is not known.
  void restart() noexcept { told_.clear(), springs_.setZero(); }

  double made() const noexcept { return made_; }  // as in Governed [J]

 private:
  ToldForces told_;
  Vec3 springs_ = Vec3::Zero();   // of the tick before, as far as the limits let them [N]
  double asked_ = 0.0;            // size of the governed force of the tick before [N]
  double limit_ = kNoForceLimit;  // what the device's limits let pass then [N]
  double stiffness_ = 0.0;        // of the springs that pushed last [N/m]
  HandWay hand_;
  double made_ = 0.0;  // [J]
};

// A spring whose other end is told over a link may give the hand no more than the hand has put into
// it: the energy in it is counted from zero, and is never more than the spring would hold at this
// force. What its other end does to it gives nothing. The hand is taken to go on as it went last:
// a slow one moves by a count of its encoder now and then, and what it is told in between acts on
// the next. A bound holds whichever way the hand goes, until it has pressed in again: a force that
// were whole one way and bounded the other would let a hand that stands hunt for ever. The force
// keeps its direction, so that none is made beside it. `stiffness` > 0 [N/m].
class EnergyTank {
 public:
  // One tick, as EnergyGovernor's. `used`: what a governor of other forces has used of what the
  // device took in this tick. It takes it once [J].
  Governed govern(const GovernorSettings& settings, const Vec3& wanted, double stiffness,
                  const Vec3& moved, double dt, bool missed = false, double used = 0.0) noexcept;
  void told(const Vec3& force) noexcept { told_.add(force); }
  void restart() noexcept { *this = EnergyTank(); }

 private:
  ToldForces told_;
  HandWay hand_;
  double energy_ = 0.0;           // that it may give back [J]
  double limit_ = kNoForceLimit;  // of the force, once it was bounded [N]
};

}  // namespace handrail
