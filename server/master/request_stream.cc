#include "server/master/request_stream.h"

#include <google/protobuf/stubs/logging.h>

#include "server/base/length_prefix.h"
#include "server/base/operator_name.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

// An order switched off, as in `engage: false`, is none.
bool has_order(const pb::Request& r) {
  switch (r.order_case()) {
    case pb::Request::kStatus: return r.status();
    case pb::Request::kEngage: return r.engage();
    case pb::Request::kDisengage: return r.disengage();
    case pb::Request::kStop: return r.stop();
    case pb::Request::kReset: return r.reset();
    case pb::Request::kHoldAlive: return r.hold_alive();
    case pb::Request::ORDER_NOT_SET: return false;
    default: return true;
  }
}

}  // namespace

bool is_order(const pb::Request& r) {
  return !r.has_status() && !r.has_stop() &&
         !(r.has_lease() && r.lease().act() == pb::LeaseOrder::SHOW);
}

std::string claim_request(const Trusted* speaker, pb::Request& request) {
  if (speaker == nullptr) {
    if (request.observer() && (request.has_stop() || is_order(request))) {
      return "the request says that who makes it only looks: leave `observer` out to give orders";
    }
    return request.has_as() ? operator_name_problem(request.as()) : std::string();
  }
  const std::string who = proven_name(speaker->name, key_id(speaker->key));
  if (request.has_as() && request.as() != speaker->name) {
    std::string text = "over the network a key says who you are, and yours says ";
    return text.append(who).append(": leave out --as ").append(shown(request.as(), 40));
  }
  if (!speaker->roles.has(Role::kOperator) && (request.has_stop() || is_order(request))) {
    std::string text = "the key of ";
    return text.append(who)
        .append(" is trusted as ")
        .append(roles_text(speaker->roles))
        .append(
            ", not as operator, and may only look: if more is meant, type where the master runs: ")
        .append("handrail keys trust ")
        .append(speaker->name)
        .append(" operator ")
        .append(key_text(speaker->key));
  }
  request.set_as(who);
  return {};
}

std::optional<Result<pb::Request>> RequestStream::next() {
  if (in_.size() < kFrameHeader) return std::nullopt;
  const std::size_t size = frame_size(in_.data());
  if (size > kMaxFrame) {
    return Status::error("a request of " + std::to_string(size) + " bytes, expected at most " +
                         std::to_string(kMaxFrame));
  }
  if (in_.size() - kFrameHeader < size) return std::nullopt;
  const google::protobuf::LogSilencer silence;  // it would write about them itself, and wait
  pb::Request request;
  const bool parsed = request.ParseFromArray(in_.data() + kFrameHeader, static_cast<int>(size));
  in_.erase(0, kFrameHeader + size);
  if (!parsed) return Status::error("the request is garbled");
  if (!has_order(request)) return Status::error("the request holds no order");
  return request;
}

}  // namespace handrail
