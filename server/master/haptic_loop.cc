#include "server/master/haptic_loop.h"

#include <algorithm>
#include <utility>

#include "server/haptic/felt.h"
#include "server/link/stall_watch.h"
#include "server/master/haptic_settings.h"
#include "server/master/wall_runs.h"

namespace handrail {
namespace {

// A tick's dt is the time that really passed, within what a step may bridge: a stall must not turn
// into one long stride of everything that decays with time.
constexpr double kShortest = 1e-4;
constexpr double kLongest = 5e-3;

constexpr std::uint64_t kQuantileTicks = 250;
// At the end the slave hears of it for this long; the force is gone well before.
constexpr Nanos kFarewell = 150 * kMillisecond;

}  // namespace

HapticLoop::HapticLoop(HapticDevice& device, const LoopScene& scene, MasterMailboxes& boxes,
                       Nanos start, MasterTap* tap, const HandleSetup& handle)
    : device_(device),
      run_(scene),
      boxes_(boxes),
      pacer_(kPeriod, start),
      tap_(tap),
      begins_(random_session_id()),
      handle_(handle),
      last_tick_(start) {
  place_device(run_.scene(), device_);
  run_.begin(begins_);
}

void HapticLoop::tick(Nanos now, Nanos turn) noexcept {
  pacer_.follow(turn);
  pacer_.woke(now);
  // A device's first turn may come before the loop's own clock begins.
  const Nanos passed = std::max<Nanos>(now - last_tick_, 0);
  tick_.dt = std::clamp(to_seconds(passed), kShortest, kLongest);
  // The device has let go meanwhile: the force begins anew.
  tick_.let_go = passed >= kForceStands;
  tick_.in.unseen = passed;
  tick_.led_by_cursor = device_.capabilities().led_by_cursor;
  last_tick_ = now;
  take_scene();
  take_slave(now);
  if (boxes_.cursor.take(cursor_)) device_.lead(cursor_);
  read_hand(now);
  read_handle();
  const OrderTicket ticket = next_order();
  tick_.in.order = ticket.order;
  tick_.ends = stop_requested_.load(std::memory_order_relaxed);
  if (tick_.ends) {
    if (stop_since_ < 0) stop_since_ = now;
    if (now - stop_since_ > kFarewell) finished_.store(true, std::memory_order_release);
  }
  if (tap_ != nullptr) keep_image(now);
  report_.out = run_.tick(tick_).out;
  report_.walls = wall_report(run_);
  device_.write(report_.out.f_H_M);
  device_.feel(felt_after(tick_.in, run_.state()));
  publish(now);
  if (tap_ != nullptr) keep_tick(now);
  // After the report: whoever has the answer finds a report that shows what the order did.
  if (ticket.id == 0) return;
  const HapticOutput& out = report_.out;
  (void)boxes_.answers.push({ticket.id, out.order_result, out.tool_distance, out.hand_latched,
                             out.tool_angle, out.tool_id});
  boxes_.doorbell.ring();
}

void HapticLoop::take_scene() noexcept {
  if (boxes_.scene.take(next_scene_)) report_.scene_pending = true;
  if (!report_.scene_pending || !run_.idle()) return;
  run_.change(next_scene_);
  place_device(run_.scene(), device_);
  report_.scene_pending = false;
  ++report_.scene_epoch;
}

void HapticLoop::take_slave(Nanos now) noexcept {
  HapticInput& in = tick_.in;
  if (boxes_.slave.take(news_)) {
    in.slave = news_.state;
    in.slave_known = news_.link.peer_epoch != 0;
  }
  in.slave_age = news_.link.age(now);
  in.link = news_.link.view(now);
  const Nanos heard = boxes_.hold_heard.load(std::memory_order_relaxed);
  in.hold_heard = heard == -kForever ? kForever : now - heard;
}

void HapticLoop::read_hand(Nanos now) noexcept {
  tick_.in.hand = hand_reading(device_.read(now));
  report_.trouble = tick_.in.hand.valid ? DeviceTrouble() : device_.trouble();
  missed_ += tick_.in.hand.force_missed ? 1 : 0;
}

// Beside the force that the device was told in the tick before: that is what the hand feels now.
void HapticLoop::read_handle() noexcept {
  const Quat& q_MH = tick_.in.hand.X_MH.q;
  if (handle_.simulated != nullptr) {
    if (const auto push = device_.simulated_push()) {
      handle_.simulated->feel(q_MH.conjugate() * *push);
    }
  }
  (void)boxes_.handle.take(handle_reading_);
  HandleForce& handle = report_.handle;
  handle = handle_force(handle_reading_, q_MH, handle_.lever_M);
  felt_share_.step(report_.out.f_H_M.force, handle.sound() ? &handle.f_H_M.force : nullptr,
                   tick_.dt);
  handle.felt_share = felt_share_.value();
}

void HapticLoop::keep_image(Nanos now) noexcept {
  tap_->image_before(++kept_.number, now, run_.scene().number, begins_,
                     [this](auto& bytes) { return run_.save(bytes); });
}

void HapticLoop::keep_tick(Nanos now) noexcept {
  kept_.at = now;
  kept_.scene = run_.scene().number;
  kept_.given = tick_;
  kept_.timing = {news_.link.received_at, news_.link.peer_sent, news_.link.round_trip};
  kept_.came = run_.result();
  kept_.turned = report_.walls.turned;
  kept_.handle = report_.handle;
  tap_->keep(kept_);
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
  report_.X_MH = run_.state().hand.X_MH;
  const SteerableHand* hand = device_.hand();
  report_.hand_moving = hand != nullptr && hand->moving();
  report_.ticks = pacer_.ticks();
  // A force that missed its turn acts a whole period late, as one of a late tick does.
  report_.overruns = pacer_.overruns() + missed_;
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
