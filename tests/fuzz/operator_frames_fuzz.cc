// The bytes that an operator sends, in pieces or at once, to requests and to whose they are. The
// first byte is the size of the pieces and who speaks.
#include <google/protobuf/stubs/logging.h>

#include <string>
#include <utility>
#include <vector>

#include "server/base/length_prefix.h"
#include "server/base/operator_name.h"
#include "server/base/plain_text.h"
#include "server/master/request_stream.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

Trusted speaker(Role role) {
  Trusted out;
  out.name = "anna";
  out.roles = Roles{role};
  out.key.bytes[0] = 2;
  return out;
}

// The requests in order, each as it would be sent again, and why there are no more.
struct Heard {
  std::vector<std::string> requests;
  std::string refusal;
  bool operator==(const Heard&) const = default;
};

void claim(pb::Request request, const Trusted* who) {
  const bool orders = is_order(request) || request.has_stop();
  const std::string problem = claim_request(who, request);
  require(is_plain_text(problem), "why a request is nobody's is plain text");
  if (who == nullptr || !problem.empty()) return;
  require(request.as() == proven_name(who->name, key_id(who->key)), "who speaks is who the key is");
  require(!orders || who->roles.has(Role::kOperator), "who may only look orders nothing");
}

Heard hear(fuzz::Bytes bytes, std::size_t piece, const Trusted* who) {
  RequestStream stream;
  Heard out;
  for (fuzz::Input in(bytes); !in.empty() && out.refusal.empty();) {
    stream.append(fuzz::text_of(in.take_bytes(piece)));
    while (auto request = stream.next()) {
      if (!request->is_ok()) {
        out.refusal = request->message();
        require(is_plain_text(out.refusal), "a refusal is plain text");
        break;
      }
      claim(**request, who);
      out.requests.push_back((*request)->SerializeAsString());
    }
    require(stream.size() < kFrameHeader + kMaxFrame + piece, "what waits is bounded");
  }
  return out;
}

}  // namespace

HANDRAIL_FUZZ(operator_frames) {
  const google::protobuf::LogSilencer silence;  // it writes of names that are no UTF-8
  static const Trusted kWho[] = {speaker(Role::kOperator), speaker(Role::kObserver)};
  fuzz::Input in(bytes);
  const auto how = in.take<std::uint8_t>();
  const Trusted* const who = how % 3 == 0 ? nullptr : &kWho[how % 3 - 1];
  const auto all = in.take_bytes(in.left());
  require(hear(all, std::size_t{1} + how / 3, who) == hear(all, all.size() + 1, who),
          "in whatever pieces they come");
}

}  // namespace handrail
