// Requests out of the bytes that one client sends, in whatever pieces they come.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "proto/operator.pb.h"
#include "server/base/status.h"
#include "server/keys/trust_list.h"

namespace handrail {

// Changes something, and is not anybody's to give.
bool is_order(const pb::Request& request);

// Why the request is not its sender's to make; or empty, and its `as` is who speaks. `speaker`: who
// it is by a key, in the list of the trusted; null: who comes over this computer's socket and says
// who they are.
std::string claim_request(const Trusted* speaker, pb::Request& request);

// The framing of the operator protocol (operator_server.h), without its socket. It holds what has
// come and was not taken.
class RequestStream {
 public:
  void append(std::string_view part) { in_.append(part); }
  // Takes the next request out; nothing: it has not come whole. An error is what its sender is to
  // be told before the connection ends: too long, garbled, no order.
  std::optional<Result<pb::Request>> next();

  std::size_t size() const noexcept { return in_.size(); }  // [bytes]
  // Lets everything go, the memory too.
  void clear() noexcept { std::string().swap(in_); }

 private:
  std::string in_;
};

}  // namespace handrail
