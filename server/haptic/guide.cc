#include "server/haptic/guide.h"

#include <algorithm>

#include "server/base/deletable.h"

namespace handrail {
namespace {

// An end this little behind the command still counts as reached [m].
constexpr double kBehind = 1e-6;
// A command this little off its reference has come to it: the last step of its way is as long as
// what a blend lets go of at once, and rounding adds less [rad].
constexpr double kTurned = 1e-6;
// Strokes of the clutch add up without end. A command further out is no place, and could not be
// sent; so much less, that rounding does not matter [m].
constexpr double kFarthestCommand = 0.999 * kFarthest;

// Rotation vector in S that turns the hand's orientation into the proxy's.
Vec3 twist_from(const Quat& q_hand, const Quat& q_proxy) {
  return rotation_log(q_proxy * q_hand.conjugate());
}

}  // namespace

Reason anchor(const ToolCall& call, const GuideSettings& settings, const Pose& X_SC,
              ToolDefinition& tool) noexcept {
  if (const Reason reason = check(call); reason != Reason::kNone) return reason;
  tool = ToolDefinition();
  tool.kind = call.kind;
  const double own = is_position_tool(call.kind) ? settings.stiffness : settings.torque_stiffness;
  tool.stiffness = call.stiffness > 0.0 ? call.stiffness : own;
  switch (call.kind) {
    case ToolKind::kPoint:
    case ToolKind::kLine:
    case ToolKind::kPlane:
      tool.p_SA = call.at_present ? X_SC.p : call.p_SA;
      if (!is_place(tool.p_SA)) return Reason::kToolValueInvalid;
      if (call.kind == ToolKind::kPlane) tool.normal_S = call.normal_S.normalized();
      if (call.kind != ToolKind::kPoint && !call.direction_S.isZero()) {
        // A plane's forward direction is taken within the plane (zero normal for a line).
        const Vec3 d = call.direction_S.normalized();
        tool.direction_S = (d - d.dot(tool.normal_S) * tool.normal_S).normalized();
        tool.one_way = call.one_way;
        if (call.has_end) {
          if (end_behind_start(call, tool.p_SA)) return Reason::kToolEndBehindStart;
          if (end_too_far(call, tool.p_SA)) return Reason::kToolValueInvalid;
          tool.has_end = true;
          tool.end = (call.p_SE - tool.p_SA).dot(tool.direction_S);
        }
      }
      break;
    case ToolKind::kNRotation:
      tool.q_ref = (call.has_q_ref ? call.q_ref : X_SC.q).normalized();
      break;
    case ToolKind::kFRotation: {
      const Vec3 of_tip = call.has_axis_T ? Vec3(call.axis_T.normalized()) : Vec3(Vec3::UnitZ());
      tool.normal_S = call.has_axis ? Vec3(call.axis_S.normalized()) : Vec3(X_SC.q * of_tip);
      tool.axis_T = has_reference(call) ? of_tip : Vec3(X_SC.q.conjugate() * tool.normal_S);
      break;
    }
    case ToolKind::kNone: return Reason::kNoSuchTool;
  }
  return Reason::kNone;
}

Pose Guide::restart(const GuideSettings& settings, const Pose& X_SC) noexcept {
  command_offset_.clear();
  command_turn_.clear();
  pull_offset_.clear();
  twist_offset_.clear();
  chasing_ = false;
  command_ = X_SC;
  proxy_.p = position_.start(X_SC.p, X_SC.p);
  proxy_.q = orientation_.start(X_SC.q);
  position_mean_.reset(proxy_.p, settings.smoother_length);
  command_offset_.absorb(X_SC.p - proxy_.p);
  pull_offset_.absorb(X_SC.p - proxy_.p);
  rejoin_orientation(settings, proxy_.q);
  Pose X_SH = X_SC;
  turning_ = brings_ && command_turn_.offset().norm() > kTurned;
  if (turning_) X_SH.q = proxy_.q;
  twist_offset_.absorb(-twist_from(X_SH.q, proxy_.q));
  return X_SH;
}

Reason Guide::call(const GuideSettings& settings, const ToolCall& wanted, const Vec3& p_ST,
                   Pose& X_SH, double* distance) noexcept {
  ToolDefinition tool;
  if (const Reason reason = anchor(wanted, settings, command_, tool); reason != Reason::kNone) {
    return reason;
  }
  // A one-way tool could reach an end that already lies behind only by going back.
  if (tool.one_way && tool.has_end &&
      (command_.p - tool.p_SA).dot(tool.direction_S) > tool.end + kBehind) {
    return Reason::kToolEndBehindStart;
  }
  tool.id = next_id_;
  if (is_position_tool(tool.kind)) {
    tool.epoch = position_.definition().epoch + 1;
    const PositionTool position(tool, settings.method, settings.delta);
    const auto off_from = [&position](const Vec3& p) {
      return (PositionTool(position).start(p, p) - p).norm();
    };
    // Out of reach the tip is elsewhere. What is anchored at the command takes neither anywhere.
    const double off = std::max(off_from(command_.p), wanted.at_present ? 0.0 : off_from(p_ST));
    if (distance != nullptr) *distance = off;
    if (!wanted.approach && off > settings.reach && kept(Check::kToolReach)) {
      return Reason::kToolFar;
    }
    change_position(settings, position, wanted.approach, X_SH);
  } else {
    tool.epoch = orientation_.definition().epoch + 1;
    change_orientation(settings, OrientationTool(tool), has_reference(wanted), X_SH);
  }
  ++next_id_;
  return Reason::kNone;
}

Reason Guide::drop_position(const GuideSettings& settings, Pose& X_SH) noexcept {
  if (!position_.active()) return Reason::kNoSuchTool;
  ToolDefinition none;
  none.epoch = position_.definition().epoch + 1;
  change_position(settings, PositionTool(none, settings.method, settings.delta), false, X_SH);
  return Reason::kNone;
}

Reason Guide::drop_orientation(const GuideSettings& settings, Pose& X_SH) noexcept {
  if (!orientation_.active()) return Reason::kNoSuchTool;
  ToolDefinition none;
  none.epoch = orientation_.definition().epoch + 1;
  change_orientation(settings, OrientationTool(none), false, X_SH);
  return Reason::kNone;
}

void Guide::change_position(const GuideSettings& settings, const PositionTool& tool, bool approach,
                            Pose& X_SH) noexcept {
  // The force is K_t times the pull: a change of K_t must not step it either.
  const double before = stiffness(settings);
  // The proxy of an approach is where neither hand nor command have come to.
  const bool pulled = !approaching_ && (position_.active() || pull_offset_.active());
  const Vec3 pull = pulled ? Vec3(proxy_.p + pull_offset_.offset() - X_SH.p) : Vec3(Vec3::Zero());
  // Where the proxy goes from there for this hand is part of the jump that is eased.
  const auto put = [&](const Vec3& from, const Vec3& p_SH) {
    position_ = tool;
    const Vec3 nearest = position_.start(from, command_.p);
    X_SH.p = approach ? nearest : p_SH;
    proxy_.p = position_.advance(X_SH.p);
  };
  if (approach || approaching_) {
    put(command_.p, command_.p);
  } else {
    put(tool.active() ? proxy_.p : X_SH.p, X_SH.p);
    if ((proxy_.p - command_.p).norm() > settings.reach && kept(Check::kToolLatch)) {
      put(command_.p, command_.p);
    }
  }
  approaching_ = approach;
  pull_offset_.clear();
  pull_offset_.absorb(pull * (before / stiffness(settings)) - (proxy_.p - X_SH.p));
  position_mean_.reset(proxy_.p, settings.smoother_length);
  command_offset_.clear();
  command_offset_.absorb(command_.p - proxy_.p);
}

void Guide::change_orientation(const GuideSettings& settings, const OrientationTool& tool,
                               bool brings, Pose& X_SH) noexcept {
  const double before = torque_stiffness(settings);
  const Vec3 pull = orientation_.active() || twist_offset_.active()
                        ? Vec3(twist_from(X_SH.q, proxy_.q) + twist_offset_.offset())
                        : Vec3(Vec3::Zero());
  orientation_ = tool;
  // The hand is taken to be where a reference will be reached, and where a way to one is broken
  // off.
  if (brings) {
    X_SH.q = orientation_.start(command_.q);
  } else if (turning_) {
    X_SH.q = command_.q;
    orientation_.start(command_.q);
  } else {
    orientation_.start(tool.active() ? proxy_.q : X_SH.q);
  }
  proxy_.q = orientation_.advance(X_SH.q);
  twist_offset_.clear();
  twist_offset_.absorb(pull * (before / torque_stiffness(settings)) - twist_from(X_SH.q, proxy_.q));
  rejoin_orientation(settings, proxy_.q);
  brings_ = brings;
  turning_ = brings && command_turn_.active();
  chasing_ = settings.chase && !tool.active();
  if (chasing_) command_turn_.clear();
}

// One tick of the way from `q_SC` to the hand's orientation.
Quat Guide::chase(const GuideSettings& settings, const Quat& q_SC, const Quat& q_wanted,
                  double dt) noexcept {
  const Vec3 way = rotation_log(q_SC.conjugate() * q_wanted);
  const double left = way.norm(), most = settings.catch_up_rotation * dt;
  chasing_ = left > most;
  return chasing_ ? (q_SC * rotation_exp((most / left) * way)).normalized() : q_wanted;
}

void Guide::rejoin_orientation(const GuideSettings& settings, const Quat& q_proxy) noexcept {
  orientation_mean_.reset(q_proxy, settings.smoother_length);
  command_turn_.clear();
  command_turn_.absorb(rotation_log(q_proxy.conjugate() * command_.q));
}

Guidance Guide::step(const GuideSettings& settings, const Pose& X_SH, double dt) noexcept {
  Guidance out;
  command_offset_.decay(settings.catch_up, dt);
  approaching_ = approaching_ && command_offset_.active();
  command_turn_.decay(settings.catch_up_rotation, dt);
  turning_ = turning_ && command_turn_.active();
  pull_offset_.decay(settings.force_rate / stiffness(settings), dt);
  twist_offset_.decay(settings.catch_up_rotation, dt);

  proxy_.p = position_.advance(X_SH.p);
  proxy_.q = orientation_.advance(X_SH.q);
  if (orientation_.rejoined()) rejoin_orientation(settings, proxy_.q);

  command_.p = position_mean_.push(proxy_.p) + command_offset_.offset();
  if (const double far = command_.p.norm(); far > kFarthestCommand) {
    command_.p *= kFarthestCommand / far;
    out.beyond = true;
  }
  const Quat before = command_.q;
  const Quat mean = orientation_mean_.push(proxy_.q);
  if (orientation_mean_.scattered()) rejoin_orientation(settings, proxy_.q);
  command_.q = mean;
  if (command_turn_.active()) {
    command_.q = (command_.q * rotation_exp(command_turn_.offset())).normalized();
  }
  const Quat wanted = command_.q;
  if (chasing_) command_.q = chase(settings, before, wanted, dt);
  out.X_SC = command_;
  out.X_SP = proxy_;
  out.pull = proxy_.p - X_SH.p + pull_offset_.offset();
  out.twist_pull = twist_offset_.offset();
  if (orientation_.active()) out.twist_pull += twist_from(X_SH.q, proxy_.q);
  out.offset = command_offset_.offset();
  out.offset_angle = chasing_ ? angle_between(command_.q, wanted) : command_turn_.offset().norm();
  out.blending =
      command_offset_.active() || command_turn_.active() || pull_offset_.active() || chasing_;
  return out;
}

double Guide::stiffness(const GuideSettings& settings) const noexcept {
  const double wanted = position_.active() ? position_.definition().stiffness : settings.stiffness;
  return std::max(kSoftest, std::min(wanted, settings.most_stiffness));
}

double Guide::torque_stiffness(const GuideSettings& settings) const noexcept {
  const double wanted =
      orientation_.active() ? orientation_.definition().stiffness : settings.torque_stiffness;
  return std::max(kSoftest, std::min(wanted, settings.most_torque_stiffness));
}

}  // namespace handrail
