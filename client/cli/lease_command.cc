#include "client/cli/lease_command.h"

#include <cmath>

#include "server/scene/json_io.h"

namespace handrail {
namespace {

// A question to the holder is decided after ten seconds at most.
constexpr Nanos kLeasePatience = 15 * kSecond;

std::string seconds(double value) { return std::to_string(std::lround(value)) + " s"; }

}  // namespace

std::string lease_text(const pb::LeaseStatus& lease) {
  if (lease.holder().empty()) return "nobody has it; engage takes it";
  std::string out = lease.holder() + " has it for " + seconds(lease.held_s()) + ", last order " +
                    seconds(lease.idle_s()) + " ago";
  if (lease.asked_by().empty()) return out;
  return out + "; " + lease.asked_by() + " asks for it, " + seconds(lease.ask_left_s()) +
         " left: lease grant, or lease refuse";
}

ExitCode run_lease_show(const Options& options, const Console& console) {
  pb::Request request;
  request.mutable_lease()->set_act(pb::LeaseOrder::SHOW);
  const Result<pb::Reply> reply =
      OperatorClient(options.master, options.as).call(request, kLeasePatience);
  const ExitCode code = exit_code(reply);
  if (code != kExitDone) {
    console.err << "handrail: " << (reply ? "refused: " + reply->reason() : reply.message())
                << '\n';
  } else if (options.json) {
    console.out << json_text(reply->lease(), true) << '\n';
  } else {
    console.out << "lease: " << lease_text(reply->lease()) << '\n';
  }
  return code;
}

ExitCode send_lease(pb::LeaseOrder::Act act, const Options& options, const Console& console) {
  pb::Request request;
  request.mutable_lease()->set_act(act);
  const char* done = "the lease is yours; engage to drive";
  if (act == pb::LeaseOrder::GRANT) done = "granted; the arm holds";
  if (act == pb::LeaseOrder::REFUSE) done = "refused; the lease stays yours";
  if (act == pb::LeaseOrder::RELEASE) done = "released; the arm holds";
  return send_order(options, console, request, done, kLeasePatience);
}

}  // namespace handrail
