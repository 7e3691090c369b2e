// What a force sensor between a device's handle and the hand tells. It controls nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "server/base/spatial.h"
#include "server/base/time.h"

namespace handrail {

// Why there is a reading of the sensor on the handle, or none.
enum class HandleState : std::uint8_t {
  kNone,     // no sensor is configured
  kWaiting,  // no record has come yet
  kZeroing,  // it has yet to be taken as zero, while nothing is engaged and no force is asked for
  kSound,
  kSilent,  // no record has come for kHandlePatience
  kFaulty,  // it reports a fault
  kBeyond   // a component is beyond its range
};

// In words, as status and log have them.
constexpr const char* describe(HandleState state) noexcept {
  switch (state) {
    case HandleState::kNone: return "none";
    case HandleState::kWaiting: return "waits for its first record";
    case HandleState::kZeroing:
      return "is taken as zero when nothing is engaged and no force is asked for";
    case HandleState::kSound: return "sound";
    case HandleState::kSilent: return "silent";
    case HandleState::kFaulty: return "reports a fault";
    case HandleState::kBeyond: return "beyond its range";
  }
  return "none";
}

// A reading, its zero taken out. `f_N_H`: what the hand exerts on the handle, about the hand's
// reference point H, in the handle's axes [N], [N m]; only with kSound.
struct HandleReading {
  HandleState state = HandleState::kNone;
  Wrench f_N_H;
};

// The same as what is felt: of the handle on the hand, frame M.
struct HandleForce {
  HandleState state = HandleState::kNone;
  Wrench f_H_M;                        // about H [N], [N m]; only with kSound
  Vec3 stick_torque_M = Vec3::Zero();  // lever x force [N m]
  bool has_stick = false;              // there is a lever
  std::optional<double> felt_share;    // measured over asked, as FeltShare has it

  bool sound() const noexcept { return state == HandleState::kSound; }
};

// `lever_M`: from a stick's pivot to H [m]; 0: it is no stick. Of a hand that is turned by `q_MH`.
// Real-time safe.
inline HandleForce handle_force(const HandleReading& reading, const Quat& q_MH,
                                const Vec3& lever_M) noexcept {
  HandleForce out;
  out.state = reading.state;
  out.has_stick = !lever_M.isZero(0.0);
  if (!out.sound()) return out;
  out.f_H_M = {-(q_MH * reading.f_N_H.force), -(q_MH * reading.f_N_H.torque)};
  if (out.has_stick) out.stick_torque_M = lever_M.cross(out.f_H_M.force);
  return out;
}

// How much of the force that a device was told is felt, along that force: the sum of measured times
// asked over that of asked squared, both fading within kWindow. Only of ticks that ask for at least
// kEnough, and known once those make up kKnown of it: less is lost in the friction of a good device
// (0.26 N of an Omni, 0.3 N of the joystick) and in what is left of the zero. Real-time safe.
class FeltShare {
 public:
  static constexpr double kWindow = 1.0;  // [s]; our choice: what a look at a display takes
  static constexpr double kEnough = 1.0;  // three times that friction [N]
  static constexpr double kKnown = 0.5;   // [s]; our choice: most of it, after 0.7 s of force

  // A tick of `dt` [s] that asked for `asked`; `measured`: null where there was none.
  void step(const Vec3& asked, const Vec3* measured, double dt) noexcept {
    const double left = kWindow / (kWindow + dt);
    product_ *= left;
    square_ *= left;
    time_ *= left;
    if (measured == nullptr || asked.squaredNorm() < kEnough * kEnough) return;
    product_ += dt * measured->dot(asked);
    square_ += dt * asked.squaredNorm();
    time_ += dt;
  }
  // None: not known. Under 0: against what is asked, of a sensor that is mounted another way round.
  std::optional<double> value() const noexcept {
    if (time_ < kKnown) return std::nullopt;
    return product_ / square_;
  }

 private:
  double product_ = 0.0, square_ = 0.0, time_ = 0.0;
};

}  // namespace handrail
