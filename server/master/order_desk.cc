#include "server/master/order_desk.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "server/base/hand_move.h"
#include "server/base/units.h"
#include "server/master/replies.h"
#include "server/master/why_report.h"
#include "server/scene/tool_io.h"

namespace handrail {
namespace {

// Three finite numbers, or none at all (zero).
bool read_vector(const google::protobuf::RepeatedField<double>& from, double unit, Vec3& to) {
  if (from.size() != 0 && from.size() != 3) return false;
  for (int i = 0; i < from.size(); ++i) to[i] = from[i] * unit;
  return is_finite(to);
}

}  // namespace

OrderDesk::OrderDesk(MasterMailboxes& boxes, Scene scene, OrderDeskOptions options)
    : boxes_(boxes), options_(std::move(options)), scene_(std::move(scene)) {}

void OrderDesk::handle(const pb::Request& request, ReplyTo reply) {
  const std::string& who = request.has_as() ? request.as() : options_.user;
  std::string refusal;
  switch (request.order_case()) {
    case pb::Request::kLease:
      leases_.handle(request.lease(), who, now_, std::move(reply));
      return watch_lease();
    case pb::Request::kStatus:
    case pb::Request::kStop:
      break;  // anybody's, always
    default: {
      const bool was_free = leases_.free();
      refusal = leases_.refusal(who, request.has_engage(), now_);
      if (request.has_engage() && was_free && refusal.empty()) borrower_ = who;
    }
  }
  if (!refusal.empty()) return reply(refused(refusal));
  obey(request, who, std::move(reply));
  give_back_lease();
}

bool OrderDesk::may_drive(const std::optional<std::string>& as) const {
  return leases_.may_drive(as ? *as : options_.user);
}

void OrderDesk::obey(const pb::Request& request, const std::string& who, ReplyTo reply) {
  switch (request.order_case()) {
    case pb::Request::kStatus: {
      if (!report_) return reply(refused("the haptic loop has not started yet"));
      pb::Reply answer = done();
      *answer.mutable_status() = status_report(options_.identity, *report_, slave_, link_, now_);
      name_stage(*answer.mutable_status());
      leases_.show(now_, *answer.mutable_status()->mutable_lease());
      return reply(std::move(answer));
    }
    case pb::Request::kEngage:
      return engage(request.hold(), std::move(reply));
    case pb::Request::kHoldAlive:
      return hold_alive(std::move(reply));
    case pb::Request::kDisengage:
      give_up_engaging();
      return order(plain(OrderKind::kDisengage), std::move(reply));
    case pb::Request::kClutch:
      return order(plain(request.clutch() ? OrderKind::kClutchOn : OrderKind::kClutchOff),
                   std::move(reply));
    case pb::Request::kStop:
      stop(std::move(reply));
      return give_up_engaging();
    case pb::Request::kReset:
      if (reset_waits_) reset_waits_(refused("another reset came after this one"));
      reset_waits_ = std::move(reply);
      reset_since_ = now_;
      return send_reset();
    case pb::Request::kTool:
      return tool(request.tool(), request.approach(), std::move(reply));
    case pb::Request::kToolOff: {
      HapticOrder off = plain(OrderKind::kToolOff);
      off.drop_position = request.tool_off().position();
      off.drop_orientation = request.tool_off().orientation();
      return order(off, std::move(reply), Until::kDropped);
    }
    case pb::Request::kSceneLoad:
      return load(request.scene_load(), who, std::move(reply));
    case pb::Request::kStage:
      return stage(request.stage(), std::move(reply));
    case pb::Request::kHand:
      return hand(request.hand(), std::move(reply));
    case pb::Request::kLease:
    case pb::Request::ORDER_NOT_SET:
      break;
  }
  reply(refused("the request holds no order this master knows"));
}

void OrderDesk::order(HapticOrder wanted, ReplyTo reply, Until until) {
  OrderTicket ticket;
  ticket.order = wanted;
  push(ticket, {std::move(reply), until, now_, wanted.tool});
}

void OrderDesk::tool(const pb::Tool& wanted, bool approach, ReplyTo reply) {
  HapticOrder call = plain(OrderKind::kTool);
  if (const auto problem = tool_call_from(wanted, call.tool)) {
    return reply(refused(problem->path + ": " + problem->text));
  }
  if (approach && !is_position_tool(call.tool.kind)) {
    return reply(refused("approach: has no meaning for " + pb::Tool::Kind_Name(wanted.kind())));
  }
  call.tool.approach = approach;
  order(call, std::move(reply));
}

std::string OrderDesk::distance_text(const OrderAnswer& answer, const ToolCall& call) const {
  const Scene::Guidance& guidance = scene_.guidance;
  if (answer.result == Reason::kToolFar) {
    return fmt::format(
        "the {} is {:.1f} mm from the tip, or from where the hand sends it, at most {:g} mm; "
        "--approach goes there",
        name_of(call.kind), answer.tool_distance / kMm, guidance.tool_reach / kMm);
  }
  if (answer.result != Reason::kNone) return {};
  if (!call.approach) {
    if (answer.hand_latched == 0.0) return {};
    return fmt::format("the hand was {:.1f} mm off and leads on from where it is",
                       answer.hand_latched / kMm);
  }
  return fmt::format("{:.1f} mm to go, about {:.1f} s; the clutch ends it",
                     answer.tool_distance / kMm, answer.tool_distance / guidance.catch_up);
}

void OrderDesk::hand(const pb::HandMove& move, ReplyTo reply) {
  OrderTicket ticket;
  ticket.is_hand = true;
  ticket.hand.duration = move.duration_s();
  ticket.hand.home = move.home();
  // What is 180 deg in degrees may be more in radians.
  constexpr double kRounding = 1.0 + 1e-12;
  const auto within = [](const Vec3& v, double most) { return v.norm() <= most * kRounding; };
  const bool whole =
      move.home() || (read_vector(move.displacement_mm(), kMm, ticket.hand.displacement_M) &&
                      read_vector(move.rotation_deg(), kDeg, ticket.hand.rotation_M));
  const double time = move.duration_s();
  if (!whole || !within(ticket.hand.displacement_M, kFarthestHandMove) ||
      !within(ticket.hand.rotation_M, kWidestHandTurn) ||
      !(time >= kShortestHandMove && time <= kLongestHandMove)) {
    return reply(refused(fmt::format(
        "hand: {:g} mm and {:g} deg in {:g} s, expected three numbers each, at most {:g} mm and "
        "{:g} deg long, and {:g} to {:g} s",
        ticket.hand.displacement_M.norm() / kMm, ticket.hand.rotation_M.norm() / kDeg, time,
        kFarthestHandMove / kMm, kWidestHandTurn / kDeg, kShortestHandMove, kLongestHandMove)));
  }
  push(ticket, {std::move(reply), Until::kTaken, now_});
}

void OrderDesk::push(OrderTicket ticket, Waiting waiting) {
  if (queue_.size() >= kMostOrders) return waiting.reply(refused("too many orders at once"));
  ticket.id = next_id_++;
  queue_.push_back(ticket);
  waiting_.emplace(ticket.id, std::move(waiting));
  feed_loop();
}

void OrderDesk::feed_loop() {
  for (; !queue_.empty() && in_loop_ < kOrdersInLoop; ++in_loop_, queue_.pop_front()) {
    if (!boxes_.orders.push(queue_.front())) return;
  }
}

// Of what was ordered before, only what the loop has already got comes before a stop: all else is
// not carried out any more. One stop that waits is as good as another. First the loop gets it: for
// all else memory may be missing.
void OrderDesk::stop(ReplyTo reply) {
  OrderTicket stop;
  stop.order = plain(OrderKind::kStop);
  std::array<std::uint64_t, kMostOrders> gone{};
  std::size_t count = 0;
  for (const OrderTicket& ticket : queue_) {
    if (ticket.order.kind == OrderKind::kStop) {
      stop.id = ticket.id;
    } else {
      gone[count++] = ticket.id;
    }
  }
  if (stop.id == 0) stop.id = next_id_++;
  if (queue_.empty()) queue_.push_back(stop);
  queue_.front() = stop;
  queue_.erase(queue_.begin() + 1, queue_.end());
  feed_loop();
  waiting_.emplace(stop.id, Waiting{std::move(reply), Until::kSlaveStopped, now_});
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = waiting_.find(gone[i]);
    if (found == waiting_.end()) continue;
    const Waiting left = std::move(found->second);
    waiting_.erase(found);
    left.reply(refused("a stop came before it"));
  }
}

void OrderDesk::tick(Nanos now, const SlaveState& slave, const LinkSnapshot& link) {
  now_ = now;
  slave_ = slave;
  link_ = link;
  take_report();
  take_answers();
  if (!report_) return;
  watch_lease();
  watch_stops();
  send_reset();
  watch_hold();
  retry_engaging();
  call_scene_tools();
  watch_engaging();
  watch_reset();
  take_scene();
  watch_scene();
  feed_loop();
  give_back_lease();
}

// Whoever has the lease next must engage: what the last holder engaged ends with the lease.
void OrderDesk::watch_lease() {
  const bool engaged = report_ && (!is_idle(report_->out.link.state) ||
                                   report_->out.link.desired != Desired::kOff || engaging_);
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

void OrderDesk::take_report() {
  HapticReport report;
  if (boxes_.report.take(report)) report_ = report;
}

void OrderDesk::take_answers() {
  OrderAnswer answer;
  while (boxes_.answers.pop(answer)) {
    take_report();  // the loop publishes before it answers: no answer is judged by an older report
    --in_loop_;
    for (auto found = waiting_.find(answer.id); found != waiting_.end();
         found = waiting_.find(answer.id)) {
      Waiting waiting = std::move(found->second);
      waiting_.erase(found);
      settle(answer, std::move(waiting));
    }
  }
}

// The loop has taken what was ordered, or refused it.
void OrderDesk::settle(const OrderAnswer& answer, Waiting waiting) {
  const bool bad_link =
      answer.result == Reason::kLinkQuality || answer.result == Reason::kNotConfirmed;
  if (bad_link && waiting.until == Until::kEngaged && now_ - waiting.since < kLinkPatience) {
    retrying_ = std::move(waiting);
    retry_at_ = now_ + kEngageRetry;
    return;
  }
  if (waiting.until == Until::kDropped && answer.result == Reason::kNoSuchTool) {
    return waiting.reply(done("there was none"));
  }
  if (answer.result != Reason::kNone) {
    std::string text = distance_text(answer, waiting.tool);
    if (text.empty())
      text = reason_text(answer.result, report_ ? report_->out.peer_fault : Reason::kNone);
    if (answer.result == Reason::kOtherMaster && link_.refused(now_)) text = unheard();
    if (waiting.until == Until::kEngaged && report_ && link_.peer_epoch != 0) {
      for (const std::string& difference : hash_mismatches(report_->out.link, slave_)) {
        text += "; " + difference;
      }
    }
    waiting.reply(refused(text));
    return;
  }
  switch (waiting.until) {
    case Until::kTaken:
    case Until::kDropped:
      waiting.reply(done(distance_text(answer, waiting.tool)));
      break;
    case Until::kEngaged:
      if (engaging_) engaging_(refused("another engage came after this one"));
      hold_ = waiting.hold;
      engaging_ = std::move(waiting.reply);
      engage_until_ = now_ + kEngagePatience;
      break;
    case Until::kSlaveStopped:
      stopping_.push_back(std::move(waiting));
      break;
    case Until::kSlaveReset:
      if (resetting_) resetting_(refused("another reset came after this one"));
      resetting_ = std::move(waiting.reply);
      reset_until_ = now_ + kResetPatience;
      break;
  }
}

std::string OrderDesk::unheard() const {
  if (link_.refused(now_)) {
    const bool latched = report_->out.link.state == SessionState::kFault;
    return other_master_text(link_, now_) + ": " +
           way_out_of(Reason::kOtherMaster, -1, JointVector::Zero(),
                      latched ? Stand::kLatched : Stand::kOff);
  }
  if (report_->walls.present) return describe(Reason::kNoArmInScene);
  if (link_.peer_epoch == 0) {
    return "no slave has answered at " + options_.slave_at + ": start handrail-slave there";
  }
  return fmt::format("the slave was last heard {} ms ago, and what it has latched stays",
                     link_.age(now_) / kMillisecond);
}

// The stop stands and is repeated whatever comes of it; the answer says whether the slave has it.
void OrderDesk::watch_stops() {
  if (now_ > report_->good_until) {
    std::erase_if(waiting_, [](const auto& entry) {
      if (entry.second.until != Until::kSlaveStopped) return false;
      entry.second.reply(
          refused("the haptic loop stands still: nothing is sent and the arm holds; "
                  "the stop acts when it goes on"));
      return true;
    });
  }
  std::erase_if(stopping_, [this](const Waiting& stop) {
    const Nanos took = now_ - stop.since;
    if (link_.refused(now_)) {
      stop.reply(refused("the stop stands here and stops nobody: " + unheard()));
    } else if (report_->walls.present) {
      stop.reply(done(unheard()));
    } else if (link_.peer_epoch == 0) {
      stop.reply(refused("the stop stands here, but none heard it: " + unheard()));
    } else if (slave_.stop_epoch == report_->out.link.stop_epoch) {
      stop.reply(done("the slave has it after " + std::to_string(took / kMillisecond) + " ms"));
    } else if (took > kStopPatience) {
      stop.reply(refused("the stop stands here, but the slave has not answered; last heard " +
                         std::to_string(link_.age(now_) / kMillisecond) + " ms ago"));
    } else {
      return false;
    }
    return true;
  });
}

// A stop that the slave has not answered is one of its faults to come. A reset that overtook it
// would be for the fault before, and the stop would stand.
bool OrderDesk::stop_on_its_way() const {
  const auto stops = [](const auto& entry) { return entry.second.until == Until::kSlaveStopped; };
  if (std::any_of(waiting_.begin(), waiting_.end(), stops)) return true;
  if (!report_ || report_->walls.present || link_.age(now_) > kHeard) return false;
  const MasterState& said = report_->out.link;
  return said.stop_epoch != said.released_epoch && said.stop_epoch != slave_.stop_epoch;
}

void OrderDesk::send_reset() {
  if (!reset_waits_ || (stop_on_its_way() && now_ - reset_since_ <= kStopPatience)) return;
  order(plain(OrderKind::kReset), std::exchange(reset_waits_, nullptr), Until::kSlaveReset);
}

void OrderDesk::watch_reset() {
  if (!resetting_) return;
  if (report_->walls.present) {
    std::exchange(resetting_, nullptr)(done("the walls are felt again"));
  } else if (link_.age(now_) > kHeard) {
    std::exchange(resetting_, nullptr)(done(unheard()));
  } else if (slave_.state != SessionState::kFault) {
    std::exchange(resetting_, nullptr)(done("engage to go on"));
  } else if (slave_.fault_epoch != report_->out.link.fault_reset || now_ > reset_until_) {
    // A later fault, or the same cause anew: what was reset is still there.
    std::exchange(resetting_, nullptr)(
        refused(std::string("the slave stays in fault: ") + describe(slave_.fault)));
  }
}

}  // namespace handrail
