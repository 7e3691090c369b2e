#include "server/master/lease.h"

#include <utility>

#include "server/base/deletable.h"

namespace handrail {
namespace {

// "42 s", "5 min", "3 h 10 min"
std::string seconds_text(Nanos time) {
  const Nanos seconds = time / kSecond;
  if (seconds < 120) return std::to_string(seconds) + " s";
  const Nanos minutes = seconds / 60;
  if (minutes < 120) return std::to_string(minutes) + " min";
  return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
}

}  // namespace

LeaseAnswer Lease::drive(const std::string& who, bool engages, Nanos now) {
  if (holder_.empty() && engages) give_to(who, " by engaging", now);
  if (!holder_.empty() && who != holder_ && kept(Check::kLease)) return not_holder(now);
  last_order_ = now;
  return {};
}

LeaseAnswer Lease::take(const std::string& who, Nanos now) {
  if (who == holder_) {
    last_order_ = now;
    return {};
  }
  if (holder_.empty()) {
    give_to(who, "", now);
    return {};
  }
  if (!asked_by_.empty() && asked_by_ != who) {
    return {false, asked_by_ + " has asked " + holder_ + " for the lease already; " +
                       seconds_text(ask_left(now)) + " left for the answer"};
  }
  if (asked_by_.empty()) {
    asked_by_ = who;
    asked_at_ = now;
    news_.push_back(who + " asks " + holder_ + " for the lease");
  }
  return {};
}

LeaseAnswer Lease::grant(const std::string& who, Nanos now) {
  if (who != holder_) return not_holder(now);
  last_order_ = now;
  if (asked_by_.empty()) return {false, "nobody asks for the lease"};
  give_to(std::string(asked_by_), ", granted by " + who, now);
  return {};
}

LeaseAnswer Lease::refuse(const std::string& who, Nanos now) {
  if (who != holder_) return not_holder(now);
  last_order_ = now;
  if (asked_by_.empty()) return {false, "nobody asks for the lease"};
  end_question(who + " refuses");
  return {};
}

void Lease::withdraw(const std::string& who) {
  if (!asked_by_.empty() && asked_by_ == who) end_question("it waits no longer");
}

LeaseAnswer Lease::release(const std::string& who, Nanos now) {
  if (who != holder_) return not_holder(now);
  if (!asked_by_.empty()) {
    give_to(std::string(asked_by_), ", released by " + who, now);
  } else {
    news_.push_back(who + " releases the lease");
    holder_.clear();
  }
  return {};
}

void Lease::poll(bool engaged, Nanos now) {
  if (holder_.empty()) return;
  // Who is engaged is there, also with no order for a while.
  if (engaged) last_order_ = now;
  if (!asked_by_.empty() && ask_left(now) <= 0) {
    if (last_order_ <= asked_at_) {
      give_to(std::string(asked_by_), ": " + holder_ + " does not answer", now);
    } else {
      end_question(holder_ + " drives and does not answer");
    }
  } else if (asked_by_.empty() && idle_for(now) > settings_.idle) {
    news_.push_back("the lease of " + holder_ + " has timed out");
    holder_.clear();
  }
}

std::vector<std::string> Lease::take_news() { return std::exchange(news_, {}); }

void Lease::give_to(const std::string& who, const std::string& how, Nanos now) {
  news_.push_back(who + " has the lease" + how);
  holder_ = who;
  asked_by_.clear();
  since_ = last_order_ = now;
}

void Lease::end_question(const std::string& how) {
  news_.push_back(asked_by_ + " does not get the lease: " + how);
  asked_by_.clear();
}

LeaseAnswer Lease::not_holder(Nanos now) const {
  if (holder_.empty()) return {false, "nobody holds the lease: 'handrail lease take' takes it"};
  return {false, holder_ + " has the lease for " + seconds_text(held_for(now)) + " (last order " +
                     seconds_text(idle_for(now)) + " ago): 'handrail lease take' asks for it"};
}

}  // namespace handrail
