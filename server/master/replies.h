// What the order desk says and orders, in short.
#pragma once

#include <string>
#include <utility>

#include "proto/operator.pb.h"
#include "server/haptic/haptic_step.h"

namespace handrail {

inline pb::Reply done(std::string note = {}) {
  pb::Reply reply;
  reply.set_done(true);
  if (!note.empty()) reply.set_reason(std::move(note));
  return reply;
}

inline pb::Reply refused(std::string why) {
  pb::Reply reply;
  reply.set_done(false);
  reply.set_reason(std::move(why));
  return reply;
}

// What follows a sentence that is not the whole reason; nothing where there is nothing to add.
inline std::string with_colon(const std::string& more) {
  return more.empty() ? std::string() : ": " + more;
}

inline HapticOrder plain(OrderKind kind) {
  HapticOrder order;
  order.kind = kind;
  return order;
}

inline bool is_idle(SessionState state) {
  return state == SessionState::kOff || state == SessionState::kFault;
}

}  // namespace handrail
