// Who drives: one operator at a time, by name.
#pragma once

#include <string>
#include <vector>

#include "server/base/time.h"

namespace handrail {

struct LeaseSettings {
  Nanos idle =
      60 * kSecond;  // a holder who is not engaged and gives no order for this long loses it
  Nanos ask = 10 * kSecond;  // how long the holder has to answer who asks
};

// What came of an act: nothing to say against it, or why not.
struct LeaseAnswer {
  bool allowed = true;
  std::string refusal;
};

// The lease belongs to a name from the first engage, or a take, until it is released, granted to
// who asks, or times out. Only its holder may give orders; while nobody holds it nothing is
// engaged, and anybody may. Times are of one clock and never fall. Names are
// said, not proven, by whoever may use the operators' socket of this computer; over the network
// they are proven, and have a key's id in them.
class Lease {
 public:
  explicit Lease(LeaseSettings settings = {}) : settings_(settings) {}

  // `who` gives an order; one that engages takes a free lease.
  LeaseAnswer drive(const std::string& who, bool engages, Nanos now);
  // Takes a free lease, or asks its holder for it: allowed then means that the question stands.
  LeaseAnswer take(const std::string& who, Nanos now);
  // The holder's answer to who asks.
  LeaseAnswer grant(const std::string& who, Nanos now);
  LeaseAnswer refuse(const std::string& who, Nanos now);
  // Who asks waits no longer.
  void withdraw(const std::string& who);
  // The holder gives it back; it goes to who asks, if anybody does.
  LeaseAnswer release(const std::string& who, Nanos now);
  // Time-outs. A question nobody answers is granted when the holder is not engaged and has given no
  // order since, else refused.
  void poll(bool engaged, Nanos now);

  // Empty: nobody.
  const std::string& holder() const noexcept { return holder_; }
  const std::string& asked_by() const noexcept { return asked_by_; }
  Nanos held_for(Nanos now) const noexcept { return now - since_; }
  Nanos idle_for(Nanos now) const noexcept { return now - last_order_; }
  Nanos ask_left(Nanos now) const noexcept { return asked_at_ + settings_.ask - now; }
  // Every change of holder since the last call and every question and answer, a line each.
  std::vector<std::string> take_news();

 private:
  void give_to(const std::string& who, const std::string& how, Nanos now);
  void end_question(const std::string& how);
  LeaseAnswer not_holder(Nanos now) const;

  LeaseSettings settings_;
  std::string holder_;
  std::string asked_by_;
  Nanos since_ = 0;       // the holder has had it
  Nanos last_order_ = 0;  // of the holder
  Nanos asked_at_ = 0;
  std::vector<std::string> news_;
};

}  // namespace handrail
