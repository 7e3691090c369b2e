// What says that a contact is not what the bumper takes it for.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/base/spatial.h"
#include "server/model/bumper_settings.h"
#include "server/model/reason.h"

namespace handrail {

// Judges a contact, once a cycle. Real-time safe.
class ContactMonitor {
 public:
  // `f_E_S`: force on the tip [N]; `moved`: way of the measured tip since the last cycle [m];
  // `p_rest`: where the commands so far bring it to rest [m].
  // kSensorSign: for 8 cycles, and the sensor's lag, the tip has moved the way the force points,
  // and the force has grown; a surface pushes against the way into it. kContactUnrelieved: for 28
  // cycles the force has stayed 30 N over the threshold and has not fallen, while the tip was not
  // commanded against it.
  Reason judge(const BumperSettings& settings, const Vec3& f_E_S, const Vec3& moved,
               const Vec3& p_rest, double dt) noexcept {
    const double force = f_E_S.norm();
    const double margin = 1.0 + 6.0 * settings.noise;  // what noise does not explain [N]
    const double way = moved.norm();
    // No way explains the jump: another contact.
    if ((f_E_S - last_).norm() > settings.contact + 2.0 * settings.stiffest * way) along_ = 0;
    last_ = f_E_S;
    if (force > settings.contact && way > kSlow * dt && f_E_S.dot(moved) > 0.3 * force * way &&
        (along_ == 0 || force > high_ - margin)) {
      if (along_++ == 0) {
        first_ = f_E_S;
        high_ = force;
        way_.setZero();
      }
      way_ += moved;
      high_ = std::max(high_, force);
    } else {
      along_ = 0;
    }
    const bool pushed = (p_rest - p_rest_).dot(f_E_S) < -1e-9 * force;
    p_rest_ = p_rest;
    if (force < settings.threshold + kOver || force < most_ - margin || pushed) {
      over_ = 0;
      most_ = 0.0;
    } else {
      ++over_;
      most_ = std::max(most_, force);
    }
    const int late = static_cast<int>(std::ceil(settings.sensor_lag / dt));
    // What grows along the way only as another surface is met is none of it: the change is judged.
    const Vec3 grown = f_E_S - first_;
    if (along_ > kAlong + late && force > first_.norm() + margin &&
        grown.dot(way_) > 0.3 * grown.norm() * way_.norm()) {
      return Reason::kSensorSign;
    }
    return over_ > kOverCycles ? Reason::kContactUnrelieved : Reason::kNone;
  }

 private:
  static constexpr double kSlow = 2e-3;  // so slow is led by what is touched [m/s]
  static constexpr double kOver = 30.0;  // [N]
  static constexpr int kAlong = 8, kOverCycles = 28;

  int along_ = 0, over_ = 0;   // cycles in a row
  Vec3 first_ = Vec3::Zero();  // force when `along_` began [N]
  Vec3 way_ = Vec3::Zero();    // of the tip since then [m]
  Vec3 last_ = Vec3::Zero();   // force [N]
  double high_ = 0.0;          // most since then [N]
  double most_ = 0.0;          // since `over_` began [N]
  Vec3 p_rest_ = Vec3::Zero();
};

}  // namespace handrail
