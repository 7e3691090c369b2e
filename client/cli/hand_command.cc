#include "client/cli/hand_command.h"

#include "client/cli/vector_text.h"
#include "server/base/hand_move.h"

namespace handrail {

ExitCode run_hand_to(const Options& o, const Console& console) {
  if (!o.by && !o.rotate) return complain(console, "hand to: expected --by or --rotate");
  pb::Request request;
  pb::HandMove& move = *request.mutable_hand();
  const Result<Vec3> by = parse_vector("--by", o.by.value_or("0,0,0"), "mm", "40,0,0");
  if (!by) return complain(console, by.message());
  const Result<Vec3> turn = parse_vector("--rotate", o.rotate.value_or("0,0,0"), "deg", "0,0,30");
  if (!turn) return complain(console, turn.message());
  const Result<double> time =
      parse_number("--seconds", o.seconds.value_or("1"), kShortestHandMove, kLongestHandMove, "s");
  if (!time) return complain(console, time.message());
  move.mutable_displacement_mm()->Add(by->begin(), by->end());
  move.mutable_rotation_deg()->Add(turn->begin(), turn->end());
  move.set_duration_s(*time);
  // The master may answer when the move has ended.
  return send_order(o, console, request, "hand moves", from_seconds(*time) + 5 * kSecond);
}

ExitCode run_hand_home(const Options& o, const Console& console) {
  pb::Request request;
  request.mutable_hand()->set_home(true);
  return send_order(o, console, request, "hand goes to where it began");
}

}  // namespace handrail
