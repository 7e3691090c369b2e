// What a controller answers at its own switches, cut anywhere; and orders at the simulated one.
#include <algorithm>

#include "devices/melfa/r3_protocol.h"
#include "devices/rig/switches.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

void try_answer(std::string_view said, std::size_t piece) {
  R3Reader whole, cut;
  const auto end = whole.take(said);
  auto still = R3Reader::Said::kMore;
  for (std::size_t at = 0; at < said.size(); at += piece) {
    still = cut.take(said.substr(at, piece));
  }
  fuzz::require(end == still || said.empty(), "where it is cut does not matter");
  fuzz::require(whole.text() == cut.text(), "nor to what came");
  fuzz::require(whole.text().size() <= kMostR3Answer + 1, "no more is kept than an answer has");
  const auto answer = parse_r3_answer(whole.text());
  if (!answer) {
    fuzz::require(!answer.message().empty(), "an error says something");
    return;
  }
  fuzz::require(end != R3Reader::Said::kTooLong, "what has no end is no answer");
  fuzz::require(answer->done || answer->error >= 0, "an error's number is none below 0");
  if (const auto state = parse_r3_state(answer->body)) {
    fuzz::require(state->override_percent >= 0 && state->override_percent <= 100,
                  "an override is a share");
    fuzz::require(state->line >= 0 && state->status.alarm >= 0, "lines and alarms are counted");
    fuzz::require(state->program.find(';') == std::string::npos, "a name ends at a ;");
  }
  if (const auto status = parse_r3_dstate(answer->body)) {
    fuzz::require(status->alarm >= 0, "alarms are counted");
  }
}

// Whatever is ordered, the simulated controller answers as a controller does, and its own state can
// be read.
void try_order(std::string_view order) {
  Controller controller{ControllerOptions{}};
  Switches switches{SwitchesOptions{}};
  constexpr PeerId kPeer = 1;
  fuzz::require(parse_r3_answer(switches.answer(order, kPeer, 0, controller)).is_ok(),
                "every order has an answer");
  const auto state = parse_r3_answer(switches.answer("1;1;STATE", kPeer, 0, controller));
  fuzz::require(state && parse_r3_state(state->body), "it tells its state after that");
}

}  // namespace

// The first byte says how long the pieces are.
HANDRAIL_FUZZ(r3) {
  fuzz::Input in(bytes);
  const std::size_t piece = 1 + in.take<std::uint8_t>();
  const std::string_view said = fuzz::text_of(in.take_bytes(in.left()));
  try_answer(said, piece);
  // All others are refused before they are looked at.
  if (said.starts_with("1;1;")) try_order(said.substr(0, 256));
}

}  // namespace handrail
