// The lease as operators' requests see it.
#pragma once

#include <functional>
#include <string>

#include "proto/operator.pb.h"
#include "server/master/lease.h"
#include "server/master/operator_server.h"

namespace handrail {

// Name of the user this program runs as, fit for a lease. Not real-time safe.
std::string own_user_name();

// Answers requests about the lease, holds the answer of who asks for it until the question is
// decided, and logs every change. All methods in the IO thread.
class LeaseDesk {
 public:
  using ReplyTo = std::function<void(pb::Reply)>;

  explicit LeaseDesk(LeaseSettings settings = {}) : lease_(settings) {}

  void handle(const pb::LeaseOrder& order, const std::string& who, Nanos now, ReplyTo reply,
              StillWaits waits);
  // Why `who` may not give an order now; empty: it may. One that engages takes a free lease.
  std::string refusal(const std::string& who, bool engages, Nanos now);
  bool free() const noexcept { return lease_.holder().empty(); }
  bool may_drive(const std::string& who) const { return free() || lease_.holder() == who; }
  // What `who` took for an engage that was then refused. Nobody's loss.
  void give_back(const std::string& who, Nanos now);
  // Time-outs, answers and the log. True when a holder has lost the lease since the last call.
  bool tick(bool engaged, Nanos now);
  void show(Nanos now, pb::LeaseStatus& out) const;

 private:
  Lease lease_;
  std::string last_holder_;
  std::string asking_;  // whose question stands, with `asked_reply_`
  ReplyTo asked_reply_;
  StillWaits asker_waits_;
};

}  // namespace handrail
