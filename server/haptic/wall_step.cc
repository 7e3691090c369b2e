#include "server/haptic/wall_step.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kOnset = 0.5e-3;  // over which a wall's damper comes on [m]

bool within(const Vec2& v, double most) { return v.allFinite() && v.cwiseAbs().maxCoeff() <= most; }

Vec2 in_plane(const Vec3& v) { return v.head<2>(); }
Vec3 in_space(const Vec2& v) { return {v.x(), v.y(), 0.0}; }

// Puts the walls as they are in `stage`. True when the hand is elsewhere among them than before.
bool enter_stage(const Walls& walls, int stage, WallState& s) {
  Pose2 pose;
  std::uint64_t gone = 0;
  if (!walls.stages.empty()) {
    const WallStage& now = walls.stages[static_cast<std::size_t>(stage)];
    pose = now.pose;
    gone = gone_of(now);
  }
  s.proxy->set_gone(gone);
  const bool moved = pose.p != s.pose.p || pose.angle != s.pose.angle;
  s.pose = pose;
  s.turn = Eigen::Rotation2Dd(pose.angle).toRotationMatrix();
  return moved;
}

const WallRegion* region_of(const Walls& walls, int stage, std::uint8_t index) {
  static const WallRegion nothing;
  if (index >= walls.regions.size()) return &nothing;
  return &walls.region(static_cast<std::size_t>(stage), index);
}

const std::vector<double>* detent_peaks(const Walls& walls, int stage) {
  const auto i = static_cast<std::size_t>(stage);
  const bool own = i < walls.stages.size() && !walls.stages[i].detent_peaks.empty();
  return own ? &walls.stages[i].detent_peaks : nullptr;
}

StageSigns signs_of(const EffectStack& effects, const WallOutput& out) {
  StageSigns signs;
  signs.region = out.contact.region;
  if (const auto* turned = effects.find<ProgressiveFriction>()) signs.turned = turned->alpha();
  signs.place = out.effects.place;
  return signs;
}

// What the hand's motion of this tick may change the force by [N]: twice the springs' slope, for
// the dampers that go with them, and a wall's own damper.
double allowance(const WallState& s, const WallRegion* wall, const Vec2& motion,
                 const Vec2& acceleration) {
  const double way = motion.norm();
  double out = 2.0 * (s.effects.stiffness() + s.wall_stiffness) * way;
  if (wall != nullptr && wall->damping > 0.0) {
    out += wall->damping * (acceleration.norm() + s.velocity.norm() * std::min(way / kOnset, 1.0));
  }
  return out;
}

}  // namespace

void wall_step(const WallSettings& settings, const WallInput& in, double dt, WallState& s,
               WallOutput& out) noexcept {
  const Walls& walls = *settings.walls;
  out.reasons = ReasonSet();
  out.effects = EffectTick();
  const Vec2 hand = in_plane(in.hand.X_MH.p);
  const Vec2 velocity = in_plane(in.hand.v_MH);
  const bool hand_ok = in.hand.valid && within(hand, kFarthest) && within(velocity, kFastestHand);
  const int before = s.stages.stage();
  const int stage = s.stages.now(walls, in.stage, in.stage_orders, dt);
  if (stage != before && enter_stage(walls, stage, s)) s.started = false;
  out.stage = stage;

  double allowed = 0.0;
  Vec2 force = Vec2::Zero();
  Governed governed;  // nothing while the hand is not heard
  if (hand_ok) {
    const bool back = s.gap.ends(dt, in.unseen);
    const Vec2 there = s.turn.transpose() * (hand - s.pose.p);
    if (!s.started || back) {
      s.proxy->start(there);
      s.effects.restart(there);
      s.governor.restart();
      s.hand = hand;
      s.velocity = velocity;
      s.started = true;
    }
    out.hand = there;
    out.contact = s.proxy->advance(there);
    EffectInput effect;
    effect.hand = there;
    effect.velocity = s.turn.transpose() * velocity;
    effect.proxy = out.contact.proxy;
    effect.region = region_of(walls, stage, out.contact.region);
    effect.wall = out.contact.touching ? region_of(walls, stage, out.contact.wall) : nullptr;
    effect.detent_peaks = detent_peaks(walls, stage);
    effect.dt = dt;
    effect.screw_c = in.screw_c;
    out.effects = s.effects.step(effect);
    s.stages.see(walls, signs_of(s.effects, out));
    force = settings.share * (s.turn * out.effects.force);
    if (effect.wall != nullptr) s.wall_stiffness = effect.wall->stiffness;
    const Vec2 motion = hand - s.hand;
    const Vec2 acceleration = velocity - s.velocity;
    const RenderedForce rendered{in_space(force),
                                 in_space(settings.share * (s.turn * out.effects.springs)),
                                 settings.share * out.effects.held_stiffness};
    governed =
        s.governor.govern(settings.governor, rendered, in_space(motion), dt, in.hand.force_missed);
    s.hand = hand;
    s.velocity = velocity;
    allowed = allowance(s, effect.wall, motion, acceleration);
  } else {
    s.gap.goes_on(dt, in.unseen);
    s.cut();
    out.reasons.add(Reason::kDeviceInvalid);
  }

  out.shares = s.arbiter.share(settings.force, governed.force, Vec3::Zero(), allowed,
                               hand_ok && !in.release ? Trust::kBoth : Trust::kNone, dt);
  s.governor.told(out.shares.device);
  out.energy_made = governed.made;
  out.ledger = account(out.shares, Vec3::Zero(), in_space(force), Vec3::Zero(),
                       governed.force - in_space(force), Vec3::Zero());
  out.f_H_M.force = out.shares.device;
  out.f_H_M.torque.setZero();
  if (governed.acted) out.reasons.add(Reason::kForceEnergy);
  if (out.shares.clamped) out.reasons.add(Reason::kForceClamped);
  if (out.shares.thermal) out.reasons.add(Reason::kForceContinuous);
  if (out.shares.stepped) out.reasons.add(Reason::kForceRate);
  if (in.release) out.reasons.add(Reason::kForceFaded);
}

}  // namespace handrail
