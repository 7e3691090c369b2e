#include "server/master/haptic_loop.h"

#include <algorithm>

#include "server/link/stall_watch.h"
#include "server/master/haptic_settings.h"

namespace handrail {
namespace {

// A tick's dt is the time that really passed, within what a step may bridge: a stall must not turn
// into one long stride of everything that decays with time.
constexpr double kShortest = 1e-4;
constexpr double kLongest = 5e-3;

constexpr std::uint64_t kQuantileTicks = 250;
// At the end the slave hears of it for this long; the force is gone well before.
constexpr Nanos kFarewell = 150 * kMillisecond;

bool idle(SessionState state) {
  return state == SessionState::kOff || state == SessionState::kFault;
}

}  // namespace

HapticLoop::HapticLoop(HapticDevice& device, const LoopScene& scene, MasterMailboxes& boxes,
                       Nanos start)
    : device_(device), scene_(scene), boxes_(boxes), pacer_(kPeriod, start), last_tick_(start) {
  set_device();
  begin_epochs(random_session_id(), state_);
}

void HapticLoop::tick(Nanos now) noexcept {
  pacer_.woke(now);
  const double dt = std::clamp(to_seconds(now - last_tick_), kShortest, kLongest);
  // The device has let go meanwhile: the force begins anew.
  if (now - last_tick_ >= kForceStands) let_go();
  input_.unseen = now - last_tick_;
  last_tick_ = now;
  take_scene();
  take_slave(now);
  if (boxes_.cursor.take(cursor_)) device_.lead(cursor_);
  input_.hand = hand_reading(device_.read(now));
  OrderTicket ticket = next_order();
  input_.order = ticket.order;
  if (stop_requested_.load(std::memory_order_relaxed)) {
    input_.order = HapticOrder();
    input_.order.kind = OrderKind::kDisengage;
    if (stop_since_ < 0) stop_since_ = now;
    if (now - stop_since_ > kFarewell) finished_.store(true, std::memory_order_release);
  }
  if (input_.order.kind == OrderKind::kStage && scene_.walls != nullptr &&
      input_.order.stage >= 0 &&
      static_cast<std::size_t>(input_.order.stage) < scene_.walls->settings.walls->stages.size()) {
    wall_in_.stage = input_.order.stage;
    ++wall_in_.stage_orders;
    input_.order = HapticOrder();
  }
  if (input_.order.kind == OrderKind::kScrew && scene_.walls != nullptr) {
    wall_in_.screw_c = input_.order.screw_c;
    input_.order = HapticOrder();
  }
  haptic_step(scene_.haptic, input_, dt, state_, report_.out);
  report_.walls = WallReport();
  if (scene_.walls != nullptr) feel_walls(dt);
  device_.write(report_.out.f_H_M);
  publish(now);
  // After the report: whoever has the answer finds a report that shows what the order did.
  if (ticket.id == 0) return;
  const HapticOutput& out = report_.out;
  (void)boxes_.answers.push({ticket.id, out.order_result, out.tool_distance, out.hand_latched,
                             out.tool_angle, out.tool_id});
  boxes_.doorbell.ring();
}

void HapticLoop::let_go() noexcept {
  state_.force.cut();
  state_.force.cue.cut(Cue::kNone);
  state_.force.torque.setZero();
  if (scene_.walls != nullptr) scene_.walls->state.cut();
}

// The hand begins where the scene's walls leave it free.
void HapticLoop::set_device() noexcept {
  if (scene_.walls == nullptr) return device_.simulate(DeviceEffects(), Vec3::Zero());
  const WallSettings& walls = scene_.walls->settings;
  const Vec2 start = walls.walls->stages.front().pose.to_world(walls.walls->start);
  device_.simulate(walls.device, Vec3(start.x(), start.y(), 0.0));
}

void HapticLoop::take_scene() noexcept {
  if (boxes_.scene.take(next_scene_)) report_.scene_pending = true;
  if (!report_.scene_pending || !idle(state_.lead.session)) return;
  // The force that is there goes on from one scene to the other, within their step limits.
  if (scene_.walls != nullptr) state_.force.arbiter = scene_.walls->state.arbiter;
  scene_ = next_scene_;
  if (scene_.walls != nullptr) scene_.walls->state.arbiter = state_.force.arbiter;
  set_device();
  wall_in_.stage = 0;
  wall_in_.screw_c = -1.0;
  report_.scene_pending = false;
  ++report_.scene_epoch;
}

void HapticLoop::take_slave(Nanos now) noexcept {
  if (boxes_.slave.take(news_)) {
    input_.slave = news_.state;
    input_.slave_known = news_.link.peer_epoch != 0;
  }
  input_.slave_age = news_.link.age(now);
  input_.link = news_.link.view(now);
  const Nanos heard = boxes_.hold_heard.load(std::memory_order_relaxed);
  input_.hold_heard = heard == -kForever ? kForever : now - heard;
}

void HapticLoop::feel_walls(double dt) noexcept {
  WallRun& run = *scene_.walls;
  wall_in_.hand = input_.hand;
  // Whoever leads by a cursor feels walls while the dead-man is held; a hand on a device lets go of
  // it.
  const bool gone = device_.capabilities().led_by_cursor && !state_.lead.present;
  wall_in_.release =
      gone || state_.lead.stop_latched() || stop_requested_.load(std::memory_order_relaxed);
  wall_step(run.settings, wall_in_, dt, run.state, wall_out_);
  HapticOutput& out = report_.out;
  out.f_H_M = wall_out_.f_H_M;
  out.shares = wall_out_.shares;
  out.force = wall_out_.ledger;
  out.energy_made = wall_out_.energy_made;
  out.reasons.add(wall_out_.reasons);
  report_.walls.present = true;
  report_.walls.stage = wall_out_.stage;
  report_.walls.contact = wall_out_.contact;
  report_.walls.hand = wall_out_.hand;
  report_.walls.force = run.state.turn.transpose() * wall_out_.f_H_M.force.head<2>();
  report_.walls.penetration = (wall_out_.contact.proxy - wall_out_.hand).norm();
  report_.walls.locked = wall_out_.effects.locked;
  report_.walls.place = wall_out_.effects.place;
  const auto* screw = run.state.effects.find<ProgressiveFriction>();
  report_.walls.has_screw = screw != nullptr;
  if (screw == nullptr) return;
  report_.walls.turned = screw->alpha();
  report_.walls.screw_c = screw->c();
}

OrderTicket HapticLoop::next_order() noexcept {
  OrderTicket ticket;
  while (boxes_.orders.pop(ticket)) {
    if (!ticket.is_hand) return ticket;
    SteerableHand* hand = device_.hand();
    if (hand != nullptr) hand->steer(ticket.hand);
    (void)boxes_.answers.push(
        {ticket.id, hand != nullptr ? Reason::kNone : Reason::kNotSimulated, 0.0});
  }
  return OrderTicket();
}

void HapticLoop::publish(Nanos now) noexcept {
  report_.sent_until = now + kHapticStateSent;
  report_.good_until = now + kStateStands;
  report_.X_MH = state_.hand.X_MH;
  const SteerableHand* hand = device_.hand();
  report_.hand_moving = hand != nullptr && hand->moving();
  report_.ticks = pacer_.ticks();
  report_.overruns = pacer_.overruns();
  if (report_.ticks % kQuantileTicks == 0) {
    const Histogram& late = pacer_.lateness();
    report_.late_p50 = late.quantile(0.5);
    report_.late_p99 = late.quantile(0.99);
    report_.late_p999 = late.quantile(0.999);
    report_.late_max = late.max();
  }
  boxes_.report.publish(report_);
}

}  // namespace handrail
