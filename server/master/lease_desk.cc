#include "server/master/lease_desk.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "server/base/folder_owner.h"
#include "server/base/operator_name.h"

namespace handrail {
std::string own_user_name() {
  std::string name = user_entry(::geteuid()).name;
  name.resize(std::min<std::size_t>(name.size(), 32));
  for (char& c : name) c = is_operator_name(std::string(1, c)) ? c : '-';
  return name.empty() ? fmt::format("user-{}", ::geteuid()) : name;
}

std::string LeaseDesk::refusal(const std::string& who, bool engages, Nanos now) {
  return lease_.drive(who, engages, now).refusal;
}

void LeaseDesk::handle(const pb::LeaseOrder& order, const std::string& who, Nanos now,
                       ReplyTo reply, StillWaits waits) {
  LeaseAnswer answer;
  switch (order.act()) {
    case pb::LeaseOrder::SHOW: break;
    case pb::LeaseOrder::TAKE: answer = lease_.take(who, now); break;
    case pb::LeaseOrder::GRANT: answer = lease_.grant(who, now); break;
    case pb::LeaseOrder::REFUSE: answer = lease_.refuse(who, now); break;
    case pb::LeaseOrder::RELEASE: answer = lease_.release(who, now); break;
  }
  if (answer.allowed && order.act() == pb::LeaseOrder::TAKE && lease_.holder() != who) {
    if (asked_reply_) {
      pb::Reply late;
      late.set_done(false);
      late.set_reason("another take came after this one");
      asked_reply_(late);
    }
    asking_ = who;
    asked_reply_ = std::move(reply);
    asker_waits_ = std::move(waits);
    return;
  }
  pb::Reply out;
  out.set_done(answer.allowed);
  if (!answer.allowed) out.set_reason(answer.refusal);
  show(now, *out.mutable_lease());
  reply(std::move(out));
}

void LeaseDesk::give_back(const std::string& who, Nanos now) {
  (void)lease_.release(who, now);
  if (last_holder_ == who) last_holder_ = lease_.holder();
}

bool LeaseDesk::tick(bool engaged, Nanos now) {
  // It is not given to who is not there any more.
  if (asked_reply_ && asker_waits_ && !asker_waits_()) lease_.withdraw(asking_);
  lease_.poll(engaged, now);
  std::string last_news;
  for (const std::string& line : lease_.take_news()) {
    spdlog::info("{}", line);
    last_news = line;
  }
  if (asked_reply_ && lease_.asked_by() != asking_) {
    pb::Reply out;
    out.set_done(lease_.holder() == asking_);
    if (!out.done()) out.set_reason(last_news);
    show(now, *out.mutable_lease());
    std::exchange(asked_reply_, nullptr)(std::move(out));
  }
  const bool lost = !last_holder_.empty() && lease_.holder() != last_holder_;
  last_holder_ = lease_.holder();
  return lost;
}

void LeaseDesk::show(Nanos now, pb::LeaseStatus& out) const {
  if (lease_.holder().empty()) return;
  out.set_holder(lease_.holder());
  out.set_held_s(to_seconds(lease_.held_for(now)));
  out.set_idle_s(to_seconds(lease_.idle_for(now)));
  if (lease_.asked_by().empty()) return;
  out.set_asked_by(lease_.asked_by());
  out.set_ask_left_s(to_seconds(lease_.ask_left(now)));
}

}  // namespace handrail
