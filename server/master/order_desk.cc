#include "server/master/order_desk.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/units.h"
#include "server/master/replies.h"
#include "server/master/why_report.h"
#include "server/scene/tool_io.h"

namespace handrail {
namespace {

// How often an engage that a bad link refused is tried again.
constexpr Nanos kRetryPeriod = 20 * kMillisecond;

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
    default:
      refusal = leases_.refusal(who, request.has_engage(), now_);
  }
  if (!refusal.empty()) return reply(refused(refusal));
  obey(request, std::move(reply));
}

void OrderDesk::obey(const pb::Request& request, ReplyTo reply) {
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
      give_up_engaging();
      return order(plain(OrderKind::kStop), std::move(reply), Until::kSlaveStopped);
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
      return order(off, std::move(reply));
    }
    case pb::Request::kSceneLoad:
      return load(request.scene_load(), std::move(reply));
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
  const bool good = read_vector(move.displacement_mm(), kMm, ticket.hand.displacement_M) &&
                    read_vector(move.rotation_deg(), kDeg, ticket.hand.rotation_M) &&
                    std::isfinite(move.duration_s()) && move.duration_s() > 0.0 &&
                    move.duration_s() <= 3600.0 && ticket.hand.displacement_M.norm() <= 1.0 &&
                    ticket.hand.rotation_M.norm() <= 4.0;
  if (!good) {
    return reply(
        refused("hand: expected three numbers each (at most 1000 mm, 229 deg) and a "
                "duration over 0 and up to 3600 s"));
  }
  push(ticket, {std::move(reply), Until::kTaken, now_});
}

void OrderDesk::push(OrderTicket ticket, Waiting waiting) {
  ticket.id = next_id_++;
  if (!boxes_.orders.push(ticket)) return waiting.reply(refused("too many orders at once"));
  waiting_.emplace(ticket.id, std::move(waiting));
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
  watch_scene();
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
    const auto found = waiting_.find(answer.id);
    if (found == waiting_.end()) continue;
    Waiting waiting = std::move(found->second);
    waiting_.erase(found);
    const bool bad_link =
        answer.result == Reason::kLinkQuality || answer.result == Reason::kNotConfirmed;
    if (bad_link && waiting.until == Until::kEngaged && now_ - waiting.since < kLinkPatience) {
      retrying_ = std::move(waiting);
      retry_at_ = now_ + kRetryPeriod;
      continue;
    }
    if (answer.result != Reason::kNone) {
      std::string text = distance_text(answer, waiting.tool);
      if (text.empty()) text = describe(answer.result);
      if (answer.result == Reason::kOtherMaster && link_.refused(now_)) text = unheard();
      if (waiting.until == Until::kEngaged && report_ && link_.peer_epoch != 0) {
        if (answer.result == Reason::kPeerFault) text += std::string(": ") + describe(slave_.fault);
        for (const std::string& difference : hash_mismatches(report_->out.link, slave_)) {
          text += "; " + difference;
        }
      }
      waiting.reply(refused(text));
      continue;
    }
    switch (waiting.until) {
      case Until::kTaken:
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
}

void OrderDesk::watch_engaging() {
  if (!engaging_) return;
  const HapticOutput& out = report_->out;
  const SessionState state = out.link.state;
  if (state == SessionState::kEngaged || state == SessionState::kClutched) {
    // Whoever engages learns which of the scene's tools do not hold the arm.
    if (scene_tools_ == 0) std::exchange(engaging_, nullptr)(done(tools_refused_));
  } else if (now_ > engage_until_ || out.link.desired == Desired::kOff) {
    // Of a slave that gets ready, what it waits for.
    const bool its = out.reason == Reason::kNone || out.reason == Reason::kHoming;
    std::string why = describe(its && slave_.reason != Reason::kNone ? slave_.reason : out.reason);
    if (out.reason == Reason::kPeerFault) why += std::string(": ") + describe(slave_.fault);
    std::exchange(engaging_, nullptr)(refused(why));
    order(plain(OrderKind::kDisengage), [](pb::Reply) {});
  }
}

void OrderDesk::engage(bool hold, ReplyTo reply) {
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
  push(ticket, {std::move(reply), Until::kEngaged, now_, {}, hold});
}

void OrderDesk::give_up_engaging() {
  for (auto& [id, waiting] : waiting_) {
    if (waiting.until == Until::kEngaged) waiting.since = -kLinkPatience;
  }
  if (retrying_) retrying_->reply(refused("another order came before the link was good"));
  retrying_.reset();
}

void OrderDesk::retry_engaging() {
  if (!retrying_ || now_ < retry_at_) return;
  OrderTicket ticket;
  ticket.order = plain(OrderKind::kEngage);
  push(ticket, *std::exchange(retrying_, std::nullopt));
}

void OrderDesk::hold_alive(ReplyTo reply) {
  const bool over = !report_ || report_->out.link.desired == Desired::kOff;
  if (!hold_ || over) {
    const Reason why = report_ ? report_->out.reason : Reason::kNone;
    return reply(refused(std::string("not engaged any more: ") + describe(why)));
  }
  hold_heard_ = now_;
  reply(done());
}

bool OrderDesk::hold_waits() const {
  const auto holds = [](const auto& entry) { return entry.second.hold; };
  return (retrying_ && retrying_->hold) || std::any_of(waiting_.begin(), waiting_.end(), holds);
}

// While the engage is waited for, its client cannot speak; after that it must. Where the
// configuration wants it the step sees to the rest, elsewhere the engagement ends.
void OrderDesk::watch_hold() {
  const bool waits = hold_waits();
  if (!hold_ && !waits) return;
  if (waits || engaging_) {
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

std::string OrderDesk::unheard() const {
  if (link_.refused(now_)) {
    const bool latched = report_->out.link.state == SessionState::kFault;
    return other_master_text(link_, now_) + ": " +
           way_out_of(Reason::kOtherMaster, -1, JointVector::Zero(), latched);
  }
  if (report_->walls.present) return describe(Reason::kNoArmInScene);
  if (link_.peer_epoch == 0) return "no slave is connected";
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
    } else if (link_.peer_epoch == 0 || report_->walls.present) {
      stop.reply(done(unheard()));
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
  if (link_.age(now_) > kHeard || report_->walls.present) {
    std::exchange(resetting_, nullptr)(done(unheard()));
  } else if (slave_.state != SessionState::kFault) {
    std::exchange(resetting_, nullptr)(done());
  } else if (slave_.fault_epoch != report_->out.link.fault_reset || now_ > reset_until_) {
    // A later fault, or the same cause anew: what was reset is still there.
    std::exchange(resetting_, nullptr)(
        refused(std::string("the slave stays in fault: ") + describe(slave_.fault)));
  }
}

}  // namespace handrail
