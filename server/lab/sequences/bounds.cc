#include "server/lab/sequences/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace handrail {
namespace {

constexpr double kCueSlope = 50.0;       // as cue_force() promises [N/s]
constexpr double kUnitTolerance = 1e-9;  // of a quaternion's length, chosen
// What a step in double precision rounds, at places of a metre and forces of a newton.
constexpr double kRounding = 1e-12;
// Of an angle between two quaternions, and of the end of an easing, which is dropped [rad].
constexpr double kAngleRounding = 2e-7;

bool leads(SessionState state) {
  return state == SessionState::kEngaged || state == SessionState::kClutched ||
         state == SessionState::kHold;
}

double stiffness_of(const HapticSettings& settings, const ToolDefinition& tool) {
  const double wanted = tool.kind == ToolKind::kNone ? settings.guide.stiffness : tool.stiffness;
  return std::min(wanted, settings.guide.most_stiffness);
}

double torque_stiffness_of(const HapticSettings& settings, const ToolDefinition& tool) {
  const double wanted =
      tool.kind == ToolKind::kNone ? settings.guide.torque_stiffness : tool.stiffness;
  return std::max(kSoftest, std::min(wanted, settings.guide.most_torque_stiffness));
}

bool trusted(const HapticInput& in, SessionState session) {
  if (session == SessionState::kHold || session == SessionState::kFault) return false;
  return session != SessionState::kEngaged || (in.slave.has_pose && is_place(in.slave.X_ST));
}

int not_finite(const HapticOutput& out) {
  const bool finite[] = {is_finite(out.f_H_M),          is_finite(out.link.X_SU),
                         is_finite(out.shares.tool),    is_finite(out.shares.spring),
                         is_finite(out.shares.limited), std::isfinite(out.energy_made),
                         std::isfinite(out.deviation),  std::isfinite(out.deviation_angle)};
  return static_cast<int>(std::count(std::begin(finite), std::end(finite), false));
}

}  // namespace

const char* name_of(Bound bound) noexcept {
  switch (bound) {
    case Bound::kForceStep: return "step of the force";
    case Bound::kForceCut: return "force without a reading";
    case Bound::kForcePeak: return "force";
    case Bound::kTorqueStep: return "step of the torque";
    case Bound::kTorqueCut: return "torque without a reading";
    case Bound::kTorquePeak: return "torque";
    case Bound::kCommandStep: return "step of the command";
    case Bound::kCommandTurn: return "turn of the command";
    case Bound::kUnit: return "length of its quaternion";
    case Bound::kFinite: return "numbers that are none";
    case Bound::kCount: break;
  }
  return "";
}

const char* unit_of(Bound bound) noexcept {
  switch (bound) {
    case Bound::kForceStep:
    case Bound::kForceCut:
    case Bound::kForcePeak: return "N";
    case Bound::kTorqueStep:
    case Bound::kTorqueCut:
    case Bound::kTorquePeak: return "N m";
    case Bound::kCommandStep: return "m";
    case Bound::kCommandTurn: return "rad";
    default: return "";
  }
}

void Watch::Way::restart(int length) {
  ways_.assign(static_cast<std::size_t>(length), 0.0);
  next_ = 0;
  sum_ = 0.0;
}

double Watch::Way::add(double way) {
  sum_ += way - ways_[next_];
  ways_[next_] = way;
  if (++next_ == ways_.size()) {
    next_ = 0;
    sum_ = std::accumulate(ways_.begin(), ways_.end(), 0.0);  // so that rounding does not add up
  }
  return sum_;
}

Watch::Watch(const HapticSettings& settings) : settings_(settings) {
  way_.restart(settings.guide.smoother_length);
  turned_.restart(settings.guide.smoother_length);
}

void Watch::judge(Bound bound, double measured, double allowed) {
  double ratio = measured == 0.0 ? 0.0 : measured / allowed;
  if (!std::isfinite(ratio)) ratio = std::numeric_limits<double>::infinity();
  judged_[static_cast<std::size_t>(bound)] = {ratio, measured, allowed};
}

void Watch::see(const HapticInput& in, double dt, const HapticState& state,
                const HapticOutput& out) {
  judged_.fill(Judged());
  // As the step says itself.
  const bool hand_ok = in.hand.valid && is_place(in.hand.X_MH) && is_finite(in.hand.v_MH) &&
                       in.hand.v_MH.cwiseAbs().maxCoeff() <= kFastestHand;
  double moved = 0.0, turned = 0.0, faster = 0.0;
  if (hand_ok) {
    if (hand_known_) {
      moved = (in.hand.X_MH.p - hand_.p).norm();
      turned = angle_between(in.hand.X_MH.q, hand_.q);
      faster = (in.hand.v_MH - v_).norm();
    }
    hand_ = in.hand.X_MH;
    v_ = in.hand.v_MH;
    hand_known_ = true;
  }
  judge(Bound::kFinite, not_finite(out), 0.0);
  judge(Bound::kUnit, std::abs(out.link.X_SU.q.norm() - 1.0), kUnitTolerance);
  see_force(in, dt, hand_ok, moved, faster, state.force.surface.known(), out);
  see_torque(in, dt, hand_ok, turned, out);
  wrench_ = out.f_H_M;
  see_command(dt, moved, state, out);
}

void Watch::see_force(const HapticInput& in, double dt, bool hand_ok, double moved, double faster,
                      bool surface, const HapticOutput& out) {
  const ForceLimits& limits = settings_.force;
  const Vec3& force = out.f_H_M.force;
  judge(Bound::kForcePeak, force.norm(), limits.peak);
  const bool cue = !out.force.cue.isZero(0.0);
  if (hand_ok) {
    const ToolDefinition& tool = out.link.position_tool;
    const bool trust = trusted(in, out.link.state);
    const double touched = surface ? settings_.surface_stiffness : 0.0;
    double allowed =
        trust ? limits.step * dt * 1e3 + std::max(stiffness_of(settings_, tool), touched) * moved
              : limits.peak * dt / limits.fade_out;
    if (trust && tool.kind != ToolKind::kNone) allowed += settings_.damping * faster;
    if (!trust && out.link.state == SessionState::kHold) allowed += touched * moved;
    const double most = std::max(force.norm(), wrench_.force.norm());
    if (cue || cue_) {
      // The arbiter's own force is the device's without the cue.
      if (most + kLargestCue > limits.peak - kLargestCue) allowed *= 2.0;
      allowed += kCueSlope * dt;
    }
    judge(Bound::kForceStep, (force - wrench_.force).norm(), allowed + kRounding);
  } else {
    judge(Bound::kForceCut, force.norm(), 0.0);
  }
  cue_ = cue;
}

void Watch::see_torque(const HapticInput& in, double dt, bool hand_ok, double turned,
                       const HapticOutput& out) {
  const Vec3& torque = out.f_H_M.torque;
  judge(Bound::kTorquePeak, torque.norm(), settings_.max_torque);
  if (!hand_ok) return judge(Bound::kTorqueCut, torque.norm(), 0.0);
  double allowed = settings_.max_torque * dt / settings_.force.fade_out;
  if (settings_.has_torque) {
    allowed += kRounding;
    if (trusted(in, out.link.state))
      allowed += torque_stiffness_of(settings_, out.link.orientation_tool) * turned;
  }
  judge(Bound::kTorqueStep, (torque - wrench_.torque).norm(), allowed);
}

void Watch::see_command(double dt, double moved, const HapticState& state,
                        const HapticOutput& out) {
  const GuideSettings& guide = settings_.guide;
  const CommandState& command = state.command;
  const bool takes_over = command.driving && !drove_;
  const bool position_anew = takes_over || out.link.position_tool.epoch != position_epoch_;
  const bool orientation_anew = takes_over || command.guide.orientation().rejoined() ||
                                out.link.orientation_tool.epoch != orientation_epoch_;
  if (position_anew) way_.restart(guide.smoother_length);
  if (orientation_anew) turned_.restart(guide.smoother_length);
  const Quat& proxy = command.guide.proxy().q;
  const double way = command.driving && !position_anew ? settings_.mapping.scale * moved : 0.0;
  const double turned = command.driving && !orientation_anew ? angle_between(proxy, proxy_) : 0.0;
  const double ways = command.driving ? way_.add(way) : 0.0;
  const double arc = command.driving ? 0.5 * turned_.add(turned) : 0.0;

  led_ = leads(out.link.state) && may_lead_;
  if (led_) {
    judge(Bound::kCommandStep, (out.link.X_SU.p - X_SU_.p).norm(),
          ways / guide.smoother_length + guide.catch_up * dt + kRounding);
    const double length =
        std::max(arc < std::numbers::pi ? std::cos(0.5 * arc) : 0.0, OrientationSmoother::kLeast);
    const double sine = std::min(std::min(arc, 2.0) / guide.smoother_length / length, 1.0);
    judge(Bound::kCommandTurn, angle_between(out.link.X_SU.q, X_SU_.q),
          2.0 * std::asin(sine) + guide.catch_up_rotation * dt + kAngleRounding);
  }
  may_lead_ = leads(out.link.state);
  drove_ = command.driving;
  position_epoch_ = out.link.position_tool.epoch;
  orientation_epoch_ = out.link.orientation_tool.epoch;
  proxy_ = proxy;
  X_SU_ = out.link.X_SU;
}

}  // namespace handrail
