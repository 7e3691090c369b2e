#include "client/api/rig_client.h"

#include <utility>

#include <boost/system/system_error.hpp>

#include "client/api/master_stream.h"
#include "server/base/clock.h"

namespace handrail {

RigClient::RigClient(std::string socket, bool (*cancelled)())
    : path_(std::move(socket)), cancelled_(cancelled) {}
RigClient::~RigClient() = default;

Result<pb::RigReply> RigClient::call(const pb::RigOrder& order, Nanos patience) {
  const Nanos deadline = monotonic_now() + patience;
  const std::string place = "no simulated rig on " + path_;
  if (!stream_) {
    try {
      stream_ = make_socket_stream(
          path_, {place, "start handrail-rig with status_socket in its --config"}, cancelled_);
    } catch (const boost::system::system_error& none) {  // no descriptors are left for its reactor
      return Status::error(place + ": " + none.code().message());
    }
    if (Status connected = stream_->connect(deadline); !connected) {
      stream_.reset();
      return connected;
    }
  }
  const Result<std::string> answer = stream_->ask(order.SerializeAsString(), deadline);
  pb::RigReply reply;
  if (answer && reply.ParseFromString(*answer)) return reply;
  stream_.reset();
  return answer ? Status::error(place + ": the reply is garbled") : answer.status();
}

Result<pb::RigStatus> RigClient::look(const std::uint64_t* since, Nanos patience) {
  pb::RigOrder order;
  order.mutable_look();
  if (since != nullptr) order.mutable_look()->set_since(*since);
  const Result<pb::RigReply> reply = call(order, patience);
  if (!reply) return reply.status();
  return reply->done() ? Result(reply->status()) : Status::error("the rig: " + reply->reason());
}

Status RigClient::play(const std::string& scene, bool anew, Nanos patience) {
  pb::RigOrder order;
  order.mutable_play()->set_scene(scene);
  order.mutable_play()->set_anew(anew);
  const Result<pb::RigReply> reply = call(order, patience);
  if (!reply) return reply.status();
  return reply->done() ? Status::ok() : Status::error("the rig: " + reply->reason());
}

}  // namespace handrail
