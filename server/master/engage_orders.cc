// The order desk's work on engaging: waiting for both sides, for a better link, for who holds on;
// and on the gripper, which moves only while engaged.
#include <algorithm>
#include <utility>

#include "server/master/order_desk.h"
#include "server/master/replies.h"

namespace handrail {

std::optional<pb::Reply> OrderDesk::check_engaged(const Pending& waiting) {
  const HapticOutput& out = report_->out;
  const SessionState state = out.link.state;
  if (state == SessionState::kEngaged || state == SessionState::kClutched) {
    // Whoever engages learns which of the scene's tools do not hold the arm.
    if (scene_tools_ != 0) return std::nullopt;
    borrower_.clear();
    return done(tools_refused_);
  }
  const bool gone = waiting.waits && !waiting.waits();
  if (!gone && now_ <= waiting.deadline && out.link.desired != Desired::kOff) return std::nullopt;
  // Of a slave that gets ready, what it waits for.
  const bool its = out.reason == Reason::kNone || out.reason == Reason::kHoming;
  const Reason why = its && slave_.reason != Reason::kNone ? slave_.reason : out.reason;
  order(plain(OrderKind::kDisengage), [](pb::Reply) {});
  return refused(reason_text(why, *report_) + with_colon(link_problem()));
}

void OrderDesk::engage(bool hold, ReplyTo reply, StillWaits waits) {
  if (options_.presence == Presence::kHold && !hold) {
    return reply(refused("this master wants somebody there: 'handrail engage --hold'"));
  }
  // An engagement that ends with its command is not made one that goes on by itself.
  if (!hold && (hold_ || hold_waits())) {
    return reply(
        refused("your 'handrail engage --hold' is running: end that one first, or the arm would go "
                "on without it"));
  }
  give_up_engaging();
  if (hold) boxes_.hold_heard.store(now_, std::memory_order_relaxed);
  OrderTicket ticket;
  ticket.order = plain(OrderKind::kEngage);
  Pending order{std::move(reply), Until::kEngaged, now_, {}, hold};
  order.waits = std::move(waits);
  push(ticket, std::move(order));
}

void OrderDesk::give_up_engaging() {
  for (Pending& order : pending_) {
    if (order.until == Until::kEngaged && order.place == Place::kInLoop) {
      order.since = -kLinkPatience;
    }
  }
  refuse_all(Until::kEngaged, Place::kHere, "another order came before the link was good");
}

bool OrderDesk::engage_waits() const {
  return std::any_of(pending_.begin(), pending_.end(),
                     [](const Pending& order) { return order.until == Until::kEngaged; });
}

void OrderDesk::give_back_lease() {
  if (borrower_.empty() || engage_waits()) return;
  leases_.give_back(borrower_, now_);
  borrower_.clear();
}

void OrderDesk::retry_engaging() {
  if (now_ < retry_at_) return;
  auto again = take(Until::kEngaged, Place::kHere);
  // Who has hung up meanwhile does not find the arm engaged later on.
  if (!again || (again->waits && !again->waits())) return;
  OrderTicket ticket;
  ticket.order = plain(OrderKind::kEngage);
  push(ticket, std::move(*again));
}

void OrderDesk::grip(bool closed, ReplyTo reply) {
  if (slave_.gripper == GripperState::kNone) {
    const bool there = link_.peer_epoch != 0 && slave_.has_pose;
    return reply(refused(there ? "the slave's arm has no gripper: robot { gripper { } } of its "
                                 "configuration names the outputs of one"
                               : "no gripper is known of: no slave is heard, or it has no arm"));
  }
  OrderTicket ticket;
  ticket.order = plain(OrderKind::kGrip);
  ticket.order.grip = closed ? Grip::kClosed : Grip::kOpen;
  Pending order{std::move(reply), Until::kGripped, now_};
  order.deadline = now_ + kGripPatience;
  order.grip = ticket.order.grip;
  push(ticket, std::move(order));
}

std::optional<pb::Reply> OrderDesk::check_gripped(const Pending& order) const {
  const HapticOutput& out = report_->out;
  if (out.link.grip != order.grip) {
    const bool over = !follows(out.link.state) && out.link.state != SessionState::kHold;
    return refused(over ? "not engaged any more: " + reason_text(out.reason, *report_)
                        : "another order to the gripper came after this one");
  }
  if (is_as_wanted(order.grip, slave_.gripper)) return done();
  if (now_ <= order.deadline) return std::nullopt;
  return refused(std::string("the controller's outputs say '") + name_of(slave_.gripper) +
                 "' after " + std::to_string(kGripPatience / kSecond) +
                 " s; the order stands as long as the arm is engaged");
}

void OrderDesk::hold_alive(ReplyTo reply) {
  const bool over = !report_ || report_->out.link.desired == Desired::kOff;
  if (!hold_ || over) {
    const std::string why =
        report_ ? reason_text(report_->out.reason, *report_) : describe(Reason::kNone);
    return reply(refused("not engaged any more: " + why));
  }
  hold_heard_ = now_;
  reply(done());
}

bool OrderDesk::hold_waits() const {
  return std::any_of(pending_.begin(), pending_.end(), [](const Pending& order) {
    return order.hold && order.place != Place::kTaken;
  });
}

// While the engage is waited for, its client cannot speak; after that it must. Where the
// configuration wants it the step sees to the rest, elsewhere the engagement ends.
void OrderDesk::watch_hold() {
  const bool waiting = hold_waits();
  if (!hold_ && !waiting) return;
  if (waiting || waits(Until::kEngaged, Place::kTaken)) {
    hold_heard_ = now_;
  } else if (report_->out.link.desired == Desired::kOff) {
    hold_ = false;
    return;
  }
  boxes_.hold_heard.store(hold_heard_, std::memory_order_relaxed);
  if (options_.presence == Presence::kHold || now_ - hold_heard_ <= kHoldPatience) return;
  hold_ = false;
  end_engagement(Reason::kPresence);
}

}  // namespace handrail
