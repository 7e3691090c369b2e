// What spacenavd says to its clients, cut anywhere.
#include <algorithm>

#include "devices/spacemouse/spnav_stream.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

bool same_spnav(const SpnavState& a, const SpnavState& b) {
  return a.counts == b.counts && a.buttons == b.buttons && a.unplugged == b.unplugged &&
         a.motions == b.motions;
}

}  // namespace

// The first byte says how long the pieces are.
HANDRAIL_FUZZ(spnav) {
  fuzz::Input in(bytes);
  const std::size_t piece = 1 + in.take<std::uint8_t>();
  const fuzz::Bytes said = in.take_bytes(in.left());
  SpnavStream whole, cut;
  const bool sound = whole.take(said);
  bool still = true;
  for (std::size_t at = 0; at < said.size(); at += piece) {
    still = cut.take(said.subspan(at, std::min(piece, said.size() - at)));
  }
  fuzz::require(sound == still, "where it is cut does not matter");
  fuzz::require(same_spnav(whole.state(), cut.state()), "nor to what it says");
  fuzz::require(whole.protocol() == cut.protocol(), "nor to the protocol");
  fuzz::require(whole.protocol() <= 0xff, "a protocol is a byte");
  fuzz::require(whole.state().motions <= said.size() / kSpnavRecord, "a motion is a whole record");
  fuzz::require(!whole.state().unplugged || whole.state().buttons == 0,
                "nobody holds a button of what was taken away");
}

}  // namespace handrail
