// The link's codec. The first byte says what the rest is: 0 a datagram as it came; else the payload
// of a sound frame: 1 a master's, 2 a slave's, 3 a refusal.
#include "server/link/check.h"
#include "server/link/frame.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

using fuzz::require;

// Whatever passes is sound, and comes back bit for bit when it is sent again.
template <typename State>
void decode_state(Codec& codec, fuzz::Bytes bytes) {
  DatagramHeader header, again_header;
  State state, again;
  if (codec.decode(bytes, header, state) != Reject::kNone) return;
  require(check(state) == Reject::kNone, "a state that passes is sound");
  require(header.session != 0 && header.sequence != 0 && header.sent >= 0 &&
              header.echo_held >= 0 && header.received_of_100 <= 100,
          "a header that passes is sound");
  std::array<std::uint8_t, kMaxDatagram> out;
  Reject cause = Reject::kNone;
  const std::size_t size = codec.encode(header, state, out, cause);
  require(size != 0 && cause == Reject::kNone, "what was received can be sent");
  require(codec.decode(std::span(out).first(size), again_header, again) == Reject::kNone,
          "what was sent can be received");
  require(again_header == header && same(again, state), "it comes back bit for bit");
}

void decode_refusal(Codec& codec, fuzz::Bytes bytes) {
  Refusal refusal, again;
  if (codec.decode(bytes, refusal) != Reject::kNone) return;
  require(sound(refusal), "a refusal that passes is sound");
  std::array<std::uint8_t, kMaxDatagram> out;
  const std::size_t size = codec.encode(refusal, out);
  require(size != 0 && codec.decode(std::span(out).first(size), again) == Reject::kNone,
          "a refusal can be sent again");
  require(again == refusal, "it says the same");
}

}  // namespace

HANDRAIL_FUZZ(datagram) {
  static Codec codec;
  fuzz::Input input(bytes);
  const auto kind = static_cast<std::uint8_t>(input.take<std::uint8_t>() % 4);
  const fuzz::Bytes rest = input.take_bytes(2 * kMaxDatagram);
  std::vector<std::uint8_t> datagram(rest.begin(), rest.end());
  if (kind != 0) {
    datagram.insert(datagram.begin(), kFrameBytes, 0);
    seal_frame(DatagramKind{kind}, datagram);
  }
  decode_state<MasterState>(codec, datagram);
  decode_state<SlaveState>(codec, datagram);
  decode_refusal(codec, datagram);
}

}  // namespace handrail
