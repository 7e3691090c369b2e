#include "client/cli/engage_command.h"

#include <poll.h>

#include "client/cli/interrupt.h"

namespace handrail {
namespace {

// Engaging waits for a good link and for both sides to stand on the same pose.
constexpr Nanos kEngagePatience = 30 * kSecond;
// Four signs fit into the time after which the master takes us for gone.
constexpr int kSignMs = 50;
constexpr Nanos kSignPatience = 2 * kSecond;

ExitCode fail(const Console& console, const Result<pb::Reply>& reply) {
  console.err << "handrail: " << (reply ? "refused: " + reply->reason() : reply.message()) << '\n';
  return exit_code(reply);
}

ExitCode disengage(const Options& options, const Console& console) {
  pb::Request end;
  end.set_disengage(true);
  return send_order(options, console, end, "disengaged");
}

}  // namespace

ExitCode run_engage(const Options& options, const Console& console) {
  pb::Request request;
  request.set_engage(true);
  if (!options.hold) return send_order(options, console, request, "engaged", kEngagePatience);
  request.set_hold(true);
  catch_interrupts();
  OperatorClient client(options.master, options.as, interrupted);
  const Result<pb::Reply> engaged = client.call(request, kEngagePatience);
  if (!engaged && interrupted()) {
    // The master may be about to engage.
    (void)disengage(options, console);
    return kExitInterrupted;
  }
  if (exit_code(engaged) != kExitDone) return fail(console, engaged);
  console.out << "engaged while this runs; Ctrl-C disengages\n";
  if (!engaged->reason().empty()) console.out << engaged->reason() << '\n';
  console.out << std::flush;
  while (!interrupted() && console.out) {
    pb::Request sign;
    sign.set_hold_alive(true);
    const Result<pb::Reply> heard = client.call(sign, kSignPatience);
    if (!heard && interrupted()) break;
    if (exit_code(heard) != kExitDone) return fail(console, heard);
    ::poll(nullptr, 0, kSignMs);
  }
  return disengage(options, console);
}

ExitCode run_disengage(const Options& o, const Console& c) { return disengage(o, c); }

ExitCode run_clutch(const Options& o, const Console& c) {
  if (*o.word != "on" && *o.word != "off") {
    return complain(c, "clutch: '" + *o.word + "': expected on (hand free, arm holds) or off");
  }
  pb::Request r;
  r.set_clutch(*o.word == "on");
  return send_order(o, c, r, "clutch " + *o.word);
}
ExitCode run_stop(const Options& o, const Console& c) {
  pb::Request r;
  r.set_stop(true);
  return send_order(o, c, r, "stopped until reset");
}
ExitCode run_reset(const Options& o, const Console& c) {
  pb::Request r;
  r.set_reset(true);
  return send_order(o, c, r, "reset");
}

ExitCode run_grip(const Options& o, const Console& c) {
  pb::Request r;
  r.set_grip(true);
  return send_order(o, c, r, "the gripper is told to close");
}

ExitCode run_release(const Options& o, const Console& c) {
  pb::Request r;
  r.set_grip(false);
  return send_order(o, c, r, "the gripper is told to open");
}

}  // namespace handrail
