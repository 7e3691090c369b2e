#include "server/master/order_desk.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "server/base/hand_move.h"
#include "server/base/units.h"
#include "server/master/replies.h"
#include "server/master/set_vector.h"
#include "server/master/why_report.h"

namespace handrail {
namespace {

// Three finite numbers, or none at all (zero).
bool read_vector(const google::protobuf::RepeatedField<double>& from, double unit, Vec3& to) {
  if (from.size() != 0 && from.size() != 3) return false;
  for (int i = 0; i < from.size(); ++i) to[i] = from[i] * unit;
  return is_finite(to);
}

// What is 180 deg in degrees may be more in radians.
bool is_within(const Vec3& v, double most) { return v.norm() <= most * (1.0 + 1e-12); }

}  // namespace

OrderDesk::OrderDesk(MasterMailboxes& boxes, Scene scene, OrderDeskOptions options)
    : boxes_(boxes), options_(std::move(options)), scene_(std::move(scene)) {
  pending_.reserve(2 * kMostOrders);
}

void OrderDesk::handle(const pb::Request& request, ReplyTo reply, StillWaits waits) {
  const std::string& who = request.has_as() ? request.as() : options_.user;
  std::string refusal;
  switch (request.order_case()) {
    case pb::Request::kLease:
      leases_.handle(request.lease(), who, now_, std::move(reply), std::move(waits));
      return watch_lease();
    case pb::Request::kStatus:
    case pb::Request::kMark:
    case pb::Request::kPrompt:
    case pb::Request::kRecord:
    case pb::Request::kStop: break;  // anybody's, always
    default: {
      const bool was_free = leases_.free();
      refusal = leases_.refusal(who, request.has_engage(), now_);
      if (request.has_engage() && was_free && refusal.empty()) borrower_ = who;
    }
  }
  if (!refusal.empty()) return reply(refused(refusal));
  obey(request, who, std::move(reply), std::move(waits));
  give_back_lease();
}

bool OrderDesk::may_drive(const std::optional<std::string>& as) const {
  return leases_.may_drive(as ? *as : options_.user);
}

void OrderDesk::obey(const pb::Request& request, const std::string& who, ReplyTo reply,
                     StillWaits waits) {
  switch (request.order_case()) {
    case pb::Request::kStatus: {
      if (!report_) return reply(refused("the haptic loop has not started yet"));
      pb::Reply answer = done();
      *answer.mutable_status() = status_report(options_.identity, *report_, slave_, link_, now_);
      show_scene(*answer.mutable_status());
      show_cursor(*answer.mutable_status());
      show_named_tools(*answer.mutable_status());
      show_task(*answer.mutable_status());
      show_recording(*answer.mutable_status());
      leases_.show(now_, *answer.mutable_status()->mutable_lease());
      return reply(std::move(answer));
    }
    case pb::Request::kEngage: return engage(request.hold(), std::move(reply), std::move(waits));
    case pb::Request::kHoldAlive: return hold_alive(std::move(reply));
    case pb::Request::kDisengage:
      give_up_engaging();
      return order(plain(OrderKind::kDisengage), std::move(reply));
    case pb::Request::kClutch:
      return order(plain(request.clutch() ? OrderKind::kClutchOn : OrderKind::kClutchOff),
                   std::move(reply));
    case pb::Request::kStop: stop(std::move(reply)); return give_up_engaging();
    case pb::Request::kReset:
      refuse_all(Until::kSlaveReset, Place::kHere, "another reset came after this one");
      pending_.push_back({std::move(reply), Until::kSlaveReset, now_, {}, false, Place::kHere});
      return send_reset();
    case pb::Request::kTool: return tool(request.tool(), request.approach(), std::move(reply));
    case pb::Request::kNamedTool:
      return named_tool(request.named_tool(), request.approach(), std::move(reply));
    case pb::Request::kToolOff: {
      HapticOrder off = plain(OrderKind::kToolOff);
      off.drop_position = request.tool_off().position();
      off.drop_orientation = request.tool_off().orientation();
      return order(off, std::move(reply), Until::kDropped);
    }
    case pb::Request::kSceneLoad: return load(request.scene_load(), who, std::move(reply));
    case pb::Request::kStage: return stage(request.stage(), std::move(reply));
    case pb::Request::kGrip: return grip(request.grip(), std::move(reply));
    case pb::Request::kScrewC: return screw(request.screw_c(), std::move(reply));
    case pb::Request::kMark: return mark(request.mark(), who, reply);
    case pb::Request::kPrompt: return prompt(request, reply);
    case pb::Request::kRecord: return record(request.record(), who, reply);
    case pb::Request::kHand: return hand(request.hand(), std::move(reply));
    case pb::Request::kCursor: return cursor(request.cursor(), reply);
    case pb::Request::kLease:
    case pb::Request::ORDER_NOT_SET: break;
  }
  reply(refused("the request holds no order this master knows"));
}

void OrderDesk::order(HapticOrder wanted, ReplyTo reply, Until until) {
  OrderTicket ticket;
  ticket.order = wanted;
  push(ticket, {std::move(reply), until, now_, wanted.tool});
}

void OrderDesk::hand(const pb::HandMove& move, ReplyTo reply) {
  OrderTicket ticket;
  ticket.is_hand = true;
  ticket.hand.duration = move.duration_s();
  ticket.hand.home = move.home();
  const bool whole =
      move.home() || (read_vector(move.displacement_mm(), kMm, ticket.hand.displacement_M) &&
                      read_vector(move.rotation_deg(), kDeg, ticket.hand.rotation_M));
  const double time = move.duration_s();
  if (!whole || !is_within(ticket.hand.displacement_M, kFarthestHandMove) ||
      !is_within(ticket.hand.rotation_M, kWidestHandTurn) ||
      !(time >= kShortestHandMove && time <= kLongestHandMove)) {
    return reply(refused(fmt::format(
        "hand: {:g} mm and {:g} deg in {:g} s, expected three numbers each, at most {:g} mm and "
        "{:g} deg long, and {:g} to {:g} s",
        ticket.hand.displacement_M.norm() / kMm, ticket.hand.rotation_M.norm() / kDeg, time,
        kFarthestHandMove / kMm, kWidestHandTurn / kDeg, kShortestHandMove, kLongestHandMove)));
  }
  push(ticket, {std::move(reply), Until::kTaken, now_});
}

// No status, no place in a queue: the newest one counts.
void OrderDesk::cursor(const pb::CursorOrder& wanted, const ReplyTo& reply) {
  if (!options_.identity.led_by_cursor) {
    return reply(refused("cursor: the device is '" + options_.identity.device +
                         "', expected the kind PAGE in the master's configuration"));
  }
  if (leases_.free()) {
    return reply(refused("cursor: nobody has the lease: take it first, 'handrail lease take'"));
  }
  Vec3 place = Vec3::Zero(), turn = Vec3::Zero();
  if (!read_vector(wanted.position_mm(), kMm, place) || wanted.position_mm().empty() ||
      !read_vector(wanted.rotation_deg(), kDeg, turn) || !is_within(place, kFarthestHandMove) ||
      !is_within(turn, kWidestHandTurn)) {
    return reply(refused(fmt::format(
        "cursor: at {:g} mm, turned {:g} deg, expected three numbers each, at most {:g} mm and "
        "{:g} "
        "deg long",
        place.norm() / kMm, turn.norm() / kDeg, kFarthestHandMove / kMm, kWidestHandTurn / kDeg)));
  }
  // What comes after a while begins anew: another page, or the same one loaded again.
  if (wanted.sequence() <= cursor_.sequence && now_ - cursor_.at <= kCursorPatience) {
    return reply(refused(fmt::format("cursor: number {} is not above {}, which has come already",
                                     wanted.sequence(), cursor_.sequence)));
  }
  cursor_.sequence = wanted.sequence();
  cursor_.X_MC = {place, rotation_exp(turn)};
  cursor_.buttons =
      (wanted.clutch() ? 1u : 0u) | (wanted.drop_tool() ? 2u : 0u) | (wanted.held() ? 4u : 0u);
  cursor_.at = now_;
  boxes_.cursor.publish(cursor_);
  reply(done());
}

void OrderDesk::show_cursor(pb::Status& status) const {
  if (!options_.identity.led_by_cursor) return;
  pb::CursorStatus& out = *status.mutable_haptic()->mutable_cursor();
  if (cursor_.at == -kForever) return;
  out.set_sequence(cursor_.sequence);
  out.set_age_ms(to_seconds(now_ - cursor_.at) * 1e3);
  out.set_held((cursor_.buttons & 4u) != 0 && now_ - cursor_.at <= kCursorPatience);
  set_vector(out.mutable_position_mm(), cursor_.X_MC.p, kMm);
}

void OrderDesk::push(OrderTicket ticket, Pending order) {
  if (queue_.size() >= kMostOrders) return order.reply(refused("too many orders at once"));
  ticket.id = order.id = next_id_++;
  order.place = Place::kInLoop;
  queue_.push_back(ticket);
  pending_.push_back(std::move(order));
  feed_loop();
}

bool OrderDesk::waits(Until until, Place place) const {
  return std::any_of(pending_.begin(), pending_.end(), [&](const Pending& order) {
    return order.until == until && order.place == place;
  });
}

std::optional<OrderDesk::Pending> OrderDesk::take(Until until, Place place) {
  const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& order) {
    return order.until == until && order.place == place;
  });
  if (found == pending_.end()) return std::nullopt;
  std::optional<Pending> out = std::move(*found);
  pending_.erase(found);
  return out;
}

void OrderDesk::refuse_all(Until until, Place place, const std::string& why) {
  while (const auto order = take(until, place)) order->reply(refused(why));
}

void OrderDesk::feed_loop() {
  for (; !queue_.empty() && in_loop_ < kOrdersInLoop; ++in_loop_, queue_.pop_front()) {
    if (!boxes_.orders.push(queue_.front())) return;
  }
}

void OrderDesk::tick(Nanos now, const LoopNews& loop, const SlaveState& slave,
                     const LinkSnapshot& link) {
  now_ = now;
  slave_ = slave;
  link_ = link;
  report_ = loop.report();
  for (const OrderAnswer& answer : loop.answers()) take(answer);
  if (!report_) return;
  watch_lease();
  if (now_ > report_->good_until) {
    refuse_all(Until::kSlaveStopped, Place::kInLoop,
               "the haptic loop stands still: nothing is sent and the arm holds; the stop acts "
               "when it goes on");
  }
  send_reset();
  watch_hold();
  retry_engaging();
  call_scene_tools();
  take_scene();
  answer_taken();
  feed_loop();
  give_back_lease();
}

// Whoever has the lease next must engage: what the last holder engaged ends with the lease.
void OrderDesk::watch_lease() {
  const bool engaged =
      report_ && (!is_idle(report_->out.link.state) || report_->out.link.desired != Desired::kOff ||
                  waits(Until::kEngaged, Place::kTaken));
  if (!leases_.tick(engaged, now_)) return;
  give_up_engaging();
  hold_ = false;
  end_engagement(Reason::kLeaseLost);
}

void OrderDesk::end_engagement(Reason why) {
  HapticOrder gone = plain(OrderKind::kDisengage);
  gone.why = why;
  order(gone, [](pb::Reply) {});
}

void OrderDesk::take(const OrderAnswer& answer) {
  --in_loop_;
  const auto its = [&](const Pending& p) { return p.place == Place::kInLoop && p.id == answer.id; };
  for (auto found = std::find_if(pending_.begin(), pending_.end(), its); found != pending_.end();
       found = std::find_if(pending_.begin(), pending_.end(), its)) {
    Pending order = std::move(*found);
    pending_.erase(found);
    settle(answer, std::move(order));
  }
}

// The loop has taken what was ordered, or refused it.
void OrderDesk::settle(const OrderAnswer& answer, Pending order) {
  const bool bad_link = answer.result == Reason::kLinkQuality ||
                        answer.result == Reason::kNotConfirmed ||
                        (answer.result == Reason::kNoPeer && session_on_its_way());
  if (bad_link && order.until == Until::kEngaged && now_ - order.since < kLinkPatience) {
    order.place = Place::kHere;
    pending_.push_back(std::move(order));
    retry_at_ = now_ + kEngageRetry;
    return;
  }
  if (order.until == Until::kDropped && answer.result == Reason::kNoSuchTool) {
    return order.reply(done("there was none"));
  }
  if (answer.result != Reason::kNone) {
    std::string text = distance_text(answer, order.tool);
    if (text.empty())
      text = report_ ? reason_text(answer.result, *report_) : describe(answer.result);
    if (answer.result == Reason::kOtherMaster && link_.refused(now_)) text = unheard();
    if (bad_link && report_ && answer.result == Reason::kLinkQuality) {
      text = link_quality_text(report_->out, link_, now_);
    }
    if (order.until == Until::kEngaged) {
      text += with_colon(answer.result == Reason::kNoPeer ? unheard() : link_problem());
    }
    if (order.until == Until::kEngaged && report_ && link_.peer_epoch != 0) {
      for (const std::string& difference : hash_mismatches(report_->out.link, slave_)) {
        text += "; " + difference;
      }
    }
    order.reply(refused(text));
    return;
  }
  if (!order.name.empty()) {
    called_by_name_[is_position_tool(order.tool.kind)] = {answer.tool_id, order.name};
  }
  order.place = Place::kTaken;
  switch (order.until) {
    case Until::kTaken:
    case Until::kDropped: return order.reply(done(distance_text(answer, order.tool)));
    case Until::kEngaged:
      refuse_all(Until::kEngaged, Place::kTaken, "another engage came after this one");
      hold_ = order.hold;
      order.deadline = now_ + kEngagePatience;
      break;
    case Until::kSlaveReset:
      refuse_all(Until::kSlaveReset, Place::kTaken, "another reset came after this one");
      order.deadline = now_ + kResetPatience;
      break;
    case Until::kSlaveStopped:
    case Until::kGripped:
    case Until::kScene: break;
  }
  pending_.push_back(std::move(order));
}

std::optional<pb::Reply> OrderDesk::check(const Pending& order) {
  switch (order.until) {
    case Until::kEngaged: return check_engaged(order);
    case Until::kSlaveReset: return check_reset(order);
    case Until::kSlaveStopped: return check_stop(order);
    case Until::kScene: return check_scene(order);
    case Until::kGripped: return check_gripped(order);
    case Until::kTaken:
    case Until::kDropped: break;
  }
  return done();
}

void OrderDesk::answer_taken() {
  for (std::size_t i = 0; i < pending_.size();) {
    std::optional<pb::Reply> answer;
    if (pending_[i].place == Place::kTaken) answer = check(pending_[i]);
    if (!answer) {
      ++i;
      continue;
    }
    const ReplyTo reply = std::move(pending_[i].reply);
    pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
    reply(std::move(*answer));
  }
}

}  // namespace handrail
