#include "client/api/operator_client.h"

#include <utility>

#include <boost/system/system_error.hpp>

#include "client/api/master_stream.h"
#include "server/base/clock.h"
#include "server/base/length_prefix.h"

namespace handrail {
namespace {

std::unique_ptr<MasterStream> stream_to(const MasterPlace& place, bool (*cancelled)(),
                                        bool with_next) {
  if (!place.host.empty()) return make_tls_stream(place, cancelled, with_next);
  return make_socket_stream(place.socket, {name_of(place), kStartMaster}, cancelled);
}

}  // namespace

OperatorClient::OperatorClient(MasterPlace place, std::string as, bool (*cancelled)())
    : place_(std::move(place)), as_(std::move(as)), cancelled_(cancelled) {}
OperatorClient::~OperatorClient() = default;

Result<pb::Reply> OperatorClient::call(const pb::Request& order, Nanos patience) {
  const Nanos deadline = monotonic_now() + patience;
  Result<pb::Reply> reply = exchange(order, deadline);
  if (!reply && stream_ && stream_->wants_other_key()) {
    with_next_key_ = false;
    close();
    reply = exchange(order, deadline);
  }
  if (!reply) close();
  return reply;
}

Result<pb::Reply> OperatorClient::exchange(const pb::Request& order, Nanos deadline) {
  pb::Request request = order;
  if (!request.has_as() && !as_.empty()) request.set_as(as_);
  const std::string payload = request.SerializeAsString();
  if (payload.size() > kMaxFrame) return failure("the request is larger than 64 KiB");
  if (!stream_) {
    try {
      stream_ = stream_to(place_, cancelled_, with_next_key_);
    } catch (const boost::system::system_error& none) {  // no descriptors are left for its reactor
      return failure(none.code().message());
    }
    if (Status status = stream_->connect(deadline); !status) return status;
  }
  const Result<std::string> body = stream_->ask(payload, deadline);
  if (!body) return body.status();
  stream_->was_answered();
  pb::Reply reply;
  if (!reply.ParseFromString(*body)) return failure("the reply is garbled");
  return reply;
}

void OperatorClient::close() noexcept { stream_.reset(); }

Status OperatorClient::failure(const std::string& what) const {
  return Status::error(name_of(place_) + ": " + what);
}

ExitCode exit_code(const Result<pb::Reply>& reply) {
  if (!reply) return kExitNoMaster;
  return reply->done() ? kExitDone : kExitRefused;
}

}  // namespace handrail
