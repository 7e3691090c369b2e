#include "server/follow/bumper.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

using Phase = BumperState::Phase;

constexpr double kSoftest = 10e3;      // stiffness to begin with [N/m]
constexpr double kLength = 1e-5;       // below it no travel is told from the encoders' [m]
constexpr double kRelief = 0.25;       // fastest way out of a force above the threshold [m/s]
constexpr double kForgotten = 1.0;     // a contact within it has the stiffness of the last [s]
constexpr double kSlowest = 0.1;       // least time constant of yielding [s]
constexpr double kReserve = 2.7;       // time constants of approach to one of loop delay
constexpr double kWidestCone = 1.4;    // half its angle [rad]
constexpr double kLift = 1e-3;         // this far out of the surface a contact may be over [m]
constexpr double kRoughness = 0.35;    // a surface falls off by at most this share of the way
constexpr double kUneven = 5e-4;       // and by this [m]
constexpr double kOvershoot = 2.5e-3;  // of the arm, past where it was told to rest [m]
constexpr double kBraking = 6.0;       // of the tip [m/s^2]
constexpr double kJerkTime = 0.02;     // until it brakes so [s]

// What one cycle reckons with.
struct Reckoning {
  const BumperSettings& settings;
  const BumperInput& in;
  double force;   // [N]
  double delay;   // of the whole loop that approaches [s]
  double margin;  // four standard deviations of the force [N]

  // Half the angle of the cone in which the normal of a surface lies, around the force [rad].
  double cone() const noexcept {
    return std::min(std::atan(settings.friction) * 1.05 + 0.02 + margin / force, kWidestCone);
  }
};

const Vec3& delayed_tip(const BumperState& s, const Reckoning& now) noexcept {
  return s.tip_before(now.settings.sensor_lag, now.in.dt);
}

void remember_tip(BumperState& s, const Vec3& p_ST) noexcept {
  if (s.newest < 0) {
    s.tips.fill(p_ST);
    s.p_touch = p_ST;
  }
  s.newest = (s.newest + 1) % BumperState::kTips;
  s.tips[static_cast<std::size_t>(s.newest)] = p_ST;
}

// How deep the tip is behind where the contact began [m].
double depth_of(const BumperState& s, const Vec3& p_ST) noexcept {
  return (s.p_touch - p_ST).dot(s.n_S);
}

void measure_stiffness(const Reckoning& now, const Vec3& p_ST, BumperState& s) noexcept {
  const BumperSettings& settings = now.settings;
  const double normal_force = std::max(0.0, now.in.f_E_S.dot(s.n_S));
  if (now.force > settings.contact) {
    const double travel = std::max(0.0, depth_of(s, p_ST));
    s.stiffness = std::max(s.stiffness, (now.force - now.margin) / (travel + kLength));
    const double rise = std::abs(normal_force - s.last_normal_force) - 2.0 * now.margin;
    if (s.last_normal_force > settings.contact && rise > 0.0) {
      const double moved = std::abs((p_ST - s.last_tip).dot(s.n_S));
      s.stiffness = std::max(s.stiffness, rise / (moved + kLength));
    }
    s.stiffness = std::clamp(s.stiffness, std::min(kSoftest, settings.stiffest), settings.stiffest);
  }
  s.last_tip = p_ST;
  s.last_normal_force = normal_force;
}

// Turns the normal toward the force until it lies in the cone.
void turn_normal(const Reckoning& now, BumperState& s) noexcept {
  if (now.force <= now.settings.contact + now.margin) return;
  const Vec3 u = now.in.f_E_S / now.force;
  const double cone = now.cone(), along = u.dot(s.n_S);
  if (along >= std::cos(cone)) return;
  const Vec3 beside = s.n_S - along * u;
  const double length = beside.norm();
  const Vec3 w = length > 1e-9 ? Vec3(beside / length) : u.unitOrthogonal();
  s.n_S = (std::cos(cone) * u + std::sin(cone) * w).normalized();
}

// What of `v` is beyond a band around 0.
double beyond(double v, double band) noexcept { return v - std::clamp(v, -band, band); }

// Above the threshold: `d` pushed out to where it goes into no surface that the force may be of.
Vec3 in_dual_cone(const Reckoning& now, const Vec3& d) noexcept {
  const Vec3 u = now.in.f_E_S / now.force;
  const double out = d.dot(u);
  const double needed = std::tan(now.cone()) * (d - out * u).norm();
  return out < needed ? Vec3(d + (needed - out) * u) : d;
}

// How fast a command goes back after a contact, in case it is met again [m/s].
double return_speed(const Reckoning& now, const BumperState& s) noexcept {
  const BumperSettings& settings = now.settings;
  const double room =
      settings.promise > 0.0 ? settings.promise - settings.threshold : 3.0 * settings.threshold;
  return std::min(approach_speed(settings, room, now.in.delay, now.in.dt),
                  0.5 * settings.threshold / (s.stiffness * (now.in.delay + 2.5 * now.in.dt)));
}

// What was held back must not be let go at once when the normal turns away from it, as where a tip
// slips off an edge: what of it lies beside the normal is given up as slowly as any.
Vec3 beside_command(const Reckoning& now, const BumperState& s) noexcept {
  const Vec3 beside = s.behind - s.behind.dot(s.n_S) * s.n_S;
  const double length = beside.norm(), most = return_speed(now, s) * now.in.dt;
  return length > most ? Vec3((1.0 - most / length) * beside) : Vec3(Vec3::Zero());
}

bool is_left(const Reckoning& now, const BumperState& s, const Vec3& p_ST,
             const Vec3& p_SB) noexcept {
  const BumperSettings& settings = now.settings;
  if (now.force >= 0.5 * settings.contact) return false;
  const double above = (now.in.p_SU - p_SB).dot(s.n_S);  // of the command, over what is followed
  if (above > -1e-7) return true;
  if (depth_of(s, p_ST) < -kLift && above > -kLift) return true;
  // So far in from where it was felt last that a surface would be felt again.
  const Vec3 way = p_ST - s.p_felt;
  const double out = way.dot(s.n_S), beside = (way - out * s.n_S).norm();
  return -out - kRoughness * beside > settings.threshold / s.stiffness + kUneven;
}

Bumped while_touching(const Reckoning& now, BumperState& s) noexcept {
  const BumperSettings& settings = now.settings;
  const BumperInput& in = now.in;
  const Vec3 p_ST = delayed_tip(s, now);
  s.apart = now.force > 0.5 * settings.contact ? 0.0 : s.apart + in.dt;
  if (in.fresh) {
    measure_stiffness(now, p_ST, s);
    turn_normal(now, s);
    if (now.force > settings.contact) s.p_felt = p_ST;
  }
  const double rate = in.dt / (s.stiffness * kReserve * now.delay);  // [m/N], each cycle
  const double slowness = std::max(kSlowest, settings.alpha * in.dt / rate);
  const double yielding = settings.alpha * std::min(now.force, settings.threshold);
  s.give +=
      std::min(1.0, in.dt / slowness) * beyond(yielding - s.give, settings.alpha * now.margin);

  // No further in above the goal, which lies below the threshold: out again. What noise may be
  // moves nothing.
  const double goal =
      std::max(0.5 * settings.threshold,
               settings.threshold - std::max(0.05 * settings.threshold, now.margin));
  const double band = std::min(now.margin, settings.threshold - goal);
  double least = std::min(rate * beyond(now.force - goal, band), kRelief * in.dt);
  if (!in.fresh) least = std::max(least, 0.0);  // no news: no further in
  // From where the arm was told to go, near where it comes to rest: it may overshoot, in or out.
  // Above the goal never from further in than it rests.
  const double rest = in.p_last.dot(s.n_S);
  const double from =
      std::clamp(s.followed.dot(s.n_S), least >= 0.0 ? rest : rest - kOvershoot, rest + kOvershoot);
  const Vec3 wanted = in.p_SU + beside_command(now, s) + s.give * s.n_S;
  const double held = from + least - wanted.dot(s.n_S);  // back, along the normal
  Bumped out{wanted + std::max(0.0, held) * s.n_S, held > 0.0 ? Reason::kBumper : Reason::kNone};
  if (depth_of(s, p_ST) > kLength) s.doubtful = false;
  if (s.doubtful) {
    const double hasty = (out.p_SB - s.followed).dot(s.n_S) - return_speed(now, s) * in.dt;
    out.p_SB -= std::max(0.0, hasty) * s.n_S;
  }
  if (is_left(now, s, p_ST, out.p_SB)) {
    s.phase = Phase::kReturning;
    s.felt = 0;
  }
  return out;
}

// After a contact: no faster to the command than to meet the surface gently again.
Bumped while_returning(const Reckoning& now, BumperState& s) noexcept {
  const Vec3 beside = beside_command(now, s);
  const double most = return_speed(now, s) * now.in.dt;
  const double out = std::max(0.0, (s.followed - now.in.p_SU).dot(s.n_S) - most);
  if (out == 0.0 && beside.isZero(0.0)) s.phase = Phase::kFree;
  return {now.in.p_SU + beside + out * s.n_S,
          s.phase == Phase::kFree ? Reason::kNone : Reason::kBumper};
}

// Slows an approach to what the promise allows: in contact the way out stays free.
Bumped approach(const Reckoning& now, const BumperState& s, Bumped out) noexcept {
  const BumperSettings& settings = now.settings;
  if (settings.promise <= 0.0) return out;
  const double most = now.in.dt * approach_speed(settings, settings.promise - settings.threshold,
                                                 now.in.delay, now.in.dt);
  // From where the arm was told to go: where it comes to rest may be a little past that, and
  // beside it while it turns. Above the threshold from where it rests, as the dual cone.
  const bool strict = s.touching() && now.force > settings.threshold;
  const Vec3 ahead = strict ? Vec3(Vec3::Zero()) : Vec3(s.followed - now.in.p_last);
  const Vec3 from = now.in.p_last + std::min(1.0, kOvershoot / (ahead.norm() + 1e-12)) * ahead;
  Vec3 step = out.p_SB - from, free = Vec3::Zero();
  if (s.touching()) free = std::max(0.0, step.dot(s.n_S)) * s.n_S;
  step -= free;
  const double length = step.norm();
  if (length <= most) return out;
  return {from + free + most / length * step,
          out.why == Reason::kNone ? Reason::kApproach : out.why};
}

Bumped bump_default(const Reckoning& now, BumperState& s) noexcept {
  const BumperSettings& settings = now.settings;
  remember_tip(s, now.in.p_ST);
  if (s.touching()) return while_touching(now, s);
  s.apart += now.in.dt;
  const bool felt = now.force > settings.contact;
  if (!felt) s.p_touch = delayed_tip(s, now);
  s.felt = felt ? s.felt + 1 : 0;
  if (s.felt >= 3 || now.force > settings.threshold) {
    s.phase = Phase::kTouching;
    s.n_S = now.in.f_E_S / now.force;
    // A surface is met on a way into it. What is met on the way out is left slowly: the sensor may
    // be telling the wrong way.
    s.doubtful = depth_of(s, delayed_tip(s, now)) < -kLength;
    if (s.apart >= kForgotten) s.stiffness = std::min(kSoftest, settings.stiffest);
    s.give = 0.0;
    s.followed = now.in.p_last;
    s.last_tip = delayed_tip(s, now);
    s.last_normal_force = now.force;
    return while_touching(now, s);
  }
  if (s.phase == Phase::kReturning) return while_returning(now, s);
  return {now.in.p_SU, Reason::kNone};
}

}  // namespace

const Vec3& BumperState::tip_before(double lag, double dt) const noexcept {
  const int age = std::clamp(static_cast<int>(std::lround(lag / dt)), 0, kTips - 1);
  return tips[static_cast<std::size_t>((newest - age + kTips) % kTips)];
}

double approach_speed(const BumperSettings& settings, double room, double delay,
                      double dt) noexcept {
  // room = k (v late + v^2 / 2a): braking begins late by the delay, and by half the time its jerk
  // takes.
  const double late = delay + 2.5 * dt + 0.5 * kJerkTime;
  const double way = std::max(0.0, room) / settings.stiffest;
  return 2.0 * way / (late + std::sqrt(late * late + 2.0 * way / kBraking));
}

Bumped bump(const BumperSettings& settings, const BumperInput& in, BumperState& state) noexcept {
  if (!settings.enabled) return {in.p_SU, Reason::kNone};
  if (settings.form == BumperSettings::Form::kPublished) {
    return bump_as_published(settings, in.p_SU, in.f_E_S, in.p_last);
  }
  const Reckoning now{settings, in, in.f_E_S.norm(), in.delay + 1.5 * in.dt, 4.0 * settings.noise};
  if (state.newest < 0) state.followed = in.p_last;
  const Bumped asked = bump_default(now, state);
  Bumped out = approach(now, state, asked);
  Vec3 unslowed = asked.p_SB;
  // Raised by the way that is gone, not by one that the promise does not let it go.
  if (state.touching() && now.force > settings.threshold) {
    out.p_SB = in.p_last + in_dual_cone(now, out.p_SB - in.p_last);
    unslowed = in.p_last + in_dual_cone(now, unslowed - in.p_last);
  }
  state.behind = unslowed - in.p_SU;
  state.followed = out.p_SB;
  return out;
}

Bumped bump_as_published(const BumperSettings& settings, const Vec3& p_SU, const Vec3& f_E_S,
                         const Vec3& p_last) noexcept {
  const double force = f_E_S.norm();
  if (force < settings.dead_band) return {p_SU, Reason::kNone};
  const Vec3 adjusted = p_SU + settings.alpha * f_E_S;  // (3.10)
  if (force <= settings.threshold) return {adjusted, Reason::kNone};
  const Vec3 d = adjusted - p_last;
  if (d.dot(f_E_S) >= 0.0) return {adjusted, Reason::kNone};
  return {adjusted + d.norm() * f_E_S / force, Reason::kBumper};
}

}  // namespace handrail
