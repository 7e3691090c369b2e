// The order desk's work on stops and resets: getting them to the slave before all else, and past
// one another.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>

#include "server/master/order_desk.h"
#include "server/master/replies.h"
#include "server/master/way_out.h"
#include "server/master/why_report.h"

namespace handrail {

// Of what was ordered before, only what the loop has already got comes before a stop: all else is
// not carried out any more. One stop that waits is as good as another. First the loop gets it: for
// all else memory may be missing.
void OrderDesk::stop(ReplyTo reply) {
  OrderTicket stop;
  stop.order = plain(OrderKind::kStop);
  for (const OrderTicket& ticket : queue_) {
    if (ticket.order.kind == OrderKind::kStop) stop.id = ticket.id;
  }
  if (stop.id == 0) stop.id = next_id_++;
  const std::uint64_t first = queue_.empty() ? 0 : queue_.front().id;
  if (queue_.empty()) queue_.push_back(stop);
  queue_.front() = stop;
  queue_.erase(queue_.begin() + 1, queue_.end());
  feed_loop();
  Pending order{std::move(reply), Until::kSlaveStopped, now_};
  order.id = stop.id;
  pending_.push_back(std::move(order));
  if (first == 0) return;
  // All that was in the queue has a number from its first one on.
  const auto overtaken = [&](const Pending& p) {
    return p.place == Place::kInLoop && p.id >= first && p.until != Until::kSlaveStopped;
  };
  for (auto found = std::find_if(pending_.begin(), pending_.end(), overtaken);
       found != pending_.end(); found = std::find_if(pending_.begin(), pending_.end(), overtaken)) {
    const Pending left = std::move(*found);
    pending_.erase(found);
    left.reply(refused("a stop came before it"));
  }
}

std::string OrderDesk::link_problem() const {
  if (const int other = link_.other_version(now_); other != 0) {
    return fmt::format(
        "the slave speaks wire version {}, this master {}: install the same Handrail on both sides",
        other, kWireVersion);
  }
  return options_.identity.link ? options_.identity.link(now_).problem : std::string();
}

bool OrderDesk::session_on_its_way() const {
  return options_.identity.link && options_.identity.link(now_).encrypted && link_problem().empty();
}

std::string OrderDesk::unheard() const {
  if (link_.refused(now_)) {
    const bool latched = report_->out.link.state == SessionState::kFault;
    return other_master_text(link_, now_) + ": " +
           way_out_of(Reason::kOtherMaster, -1, JointVector::Zero(),
                      latched ? Stand::kLatched : Stand::kOff);
  }
  if (report_->walls.present) return describe(Reason::kNoArmInScene);
  if (std::string problem = link_problem(); !problem.empty()) return problem;
  if (link_.peer_epoch == 0) {
    return "no slave has answered at " + options_.identity.slave_at +
           ": start handrail-slave there";
  }
  return fmt::format("the slave was last heard {} ms ago, and what it has latched stays",
                     link_.age(now_) / kMillisecond);
}

// The stop stands and is repeated whatever comes of it; the answer says whether the slave has it.
std::optional<pb::Reply> OrderDesk::check_stop(const Pending& stop) const {
  const Nanos took = now_ - stop.since;
  if (link_.refused(now_)) {
    return refused("the stop stands here and stops nobody: " + unheard());
  }
  if (report_->walls.present) return done(unheard());
  if (link_.peer_epoch == 0) {
    return refused("the stop stands here, but none heard it: " + unheard());
  }
  if (slave_.stop_epoch == report_->out.link.stop_epoch) {
    return done("the slave has it after " + std::to_string(took / kMillisecond) + " ms");
  }
  if (took <= kStopPatience) return std::nullopt;
  return refused("the stop stands here, but the slave has not answered; last heard " +
                 std::to_string(link_.age(now_) / kMillisecond) + " ms ago");
}

// A stop that the slave has not answered is one of its faults to come. A reset that overtook it
// would be for the fault before, and the stop would stand.
bool OrderDesk::stop_on_its_way() const {
  if (waits(Until::kSlaveStopped, Place::kInLoop)) return true;
  if (!report_ || report_->walls.present || link_.age(now_) > kHeardLately) return false;
  const MasterState& said = report_->out.link;
  return said.stop_epoch != said.released_epoch && said.stop_epoch != slave_.stop_epoch;
}

void OrderDesk::send_reset() {
  auto reset = take(Until::kSlaveReset, Place::kHere);
  if (!reset) return;
  if (stop_on_its_way() && now_ - reset->since <= kStopPatience) {
    return pending_.push_back(std::move(*reset));
  }
  order(plain(OrderKind::kReset), std::move(reset->reply), Until::kSlaveReset);
}

std::optional<pb::Reply> OrderDesk::check_reset(const Pending& order) const {
  if (report_->walls.present) return done("the walls are felt again");
  if (link_.age(now_) > kHeardLately) return done(unheard());
  if (slave_.state != SessionState::kFault) return done("engage to go on");
  if (slave_.fault_epoch == report_->out.link.fault_reset && now_ <= order.deadline) {
    return std::nullopt;
  }
  // A later fault, or the same cause anew: what was reset is still there.
  return refused(std::string("the slave stays in fault: ") + describe(slave_.fault));
}

}  // namespace handrail
