// What a tick of the master may do at most, derived from what it was told; and how near it came.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/haptic/haptic_step.h"

namespace handrail {

enum class Bound : std::uint8_t {
  kForceStep,    // of the device's force between two ticks [N]
  kForceCut,     // the force of a tick without a reading of the hand, to be 0 [N]
  kForcePeak,    // [N]
  kTorqueStep,   // [N m]
  kTorqueCut,    // as kForceCut [N m]
  kTorquePeak,   // [N m]
  kCommandStep,  // of the commanded tip between two ticks [m]
  kCommandTurn,  // [rad]
  kUnit,         // how far the command's quaternion is from a unit one
  kFinite,       // outputs that are not finite, to be 0
  kCount
};
inline constexpr std::size_t kBounds = static_cast<std::size_t>(Bound::kCount);
const char* name_of(Bound bound) noexcept;
const char* unit_of(Bound bound) noexcept;

// A tick judged: `ratio` of what was measured to what is allowed. More than 1 breaks the bound.
struct Judged {
  double ratio = 0.0;
  double measured = 0.0;
  double allowed = 0.0;
};
// Beyond what sums of a thousand numbers round.
constexpr bool breaks(double ratio) noexcept { return !(ratio <= 1.0 + 1e-9); }

// Watches one run of haptic_step() from its first tick on; the bounds for a tick of `dt`:
//
// Force step. The arbiter's: limits.step a millisecond, plus K |m| for a hand that moved by m since
// its last reading, K of the position tool, or without one the settings', as far as the device
// holds it, or of a surface that the tip touches where that is stiffer, and beside a position tool
// B times what the hand's velocity changed by since then; where the reading, the link or the slave
// is not trusted, peak dt / fade_out instead, to which a surface adds its own K |m| while the arm
// holds. While a cue plays, its own slope too, 0.05 N a millisecond; and where less than the
// largest cue is left of the peak, so much again as the arbiter's, because the cue gives way to it.
// A tick without a reading has no force at all, however much there was.
//
// Torque step: max_torque dt / fade_out, plus K |t| for a hand that turned by t since its last
// reading, K of the orientation tool, or without one the settings', as far as the device holds it;
// not while the link or the slave is not trusted. A tick without a reading has no torque either.
//
// Command step. The mean of the last N samples moves by the Nth part of what entered less what
// left, at most of the way of the hand in S over the last N ticks that it drove: proxies of tools
// move no further than the hand. Beside it the easing: catch_up dt. A change of tool, and taking
// over, begin the mean anew.
//
// Command turn. On the sphere of quaternions the mean m of N samples on a way of length Q (half of
// what the proxy turned) moves by Q / N at most and by 2 / N however long it is, and |m| >=
// cos(Q / 2) and >= kLeast, below which the command is eased over; so its direction moves by
// asin(min(Q, 2) / N / |m|), the command by twice that, and by catch_up_rotation dt. Near the pole
// of an F-rotation the proxy turns up to 22.9 times as fast as the hand, so the way is the proxy's.
class Watch {
 public:
  explicit Watch(const HapticSettings& settings);

  // The tick that haptic_step() has just made of `in`.
  void see(const HapticInput& in, double dt, const HapticState& state, const HapticOutput& out);

  const std::array<Judged, kBounds>& judged() const noexcept { return judged_; }
  bool led() const noexcept { return led_; }  // the session led the arm, in this tick and before

 private:
  // Ways of the last N ticks.
  class Way {
   public:
    void restart(int length);
    double add(double way);

   private:
    std::vector<double> ways_;
    std::size_t next_ = 0;
    double sum_ = 0.0;
  };

  void judge(Bound bound, double measured, double allowed);
  void see_torque(const HapticInput& in, double dt, bool hand_ok, double turned,
                  const HapticOutput& out);
  void see_force(const HapticInput& in, double dt, bool hand_ok, double moved, double faster,
                 bool surface, const HapticOutput& out);
  void see_command(double dt, double moved, const HapticState& state, const HapticOutput& out);

  const HapticSettings& settings_;
  std::array<Judged, kBounds> judged_{};
  bool hand_known_ = false, led_ = false, may_lead_ = false, drove_ = false;
  Pose hand_;
  Vec3 v_ = Vec3::Zero();  // of it [m/s]
  Wrench wrench_;
  bool cue_ = false;  // in the tick before
  Pose X_SU_;
  Quat proxy_ = Quat::Identity();
  std::uint32_t position_epoch_ = 0, orientation_epoch_ = 0;
  Way way_, turned_;
};

}  // namespace handrail
