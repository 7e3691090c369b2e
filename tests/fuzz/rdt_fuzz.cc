// The force sensor's records and its stream, and the simulated sensor's end: a row of acts, each a
// byte and what it needs.
#include <algorithm>

#include "devices/net_ft/rdt_client.h"
#include "devices/rig/ft_source.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

void check_rdt_codec(fuzz::Bytes bytes) {
  if (const auto record = decode_rdt_record(bytes)) {
    require(std::ranges::equal(encode_rdt(*record), bytes), "a record comes back as it was");
  }
  if (const auto request = decode_rdt_request(bytes)) {
    require(std::ranges::equal(encode_rdt(*request), bytes), "a request comes back as it was");
  }
}

class RdtStream {
 public:
  explicit RdtStream(fuzz::Bytes bytes) : in_(bytes) {}

  void run() {
    ask(client_.start(now_));
    for (int acts = 0; !in_.empty() && acts < kMostActs; ++acts) {
      switch (in_.take<std::uint8_t>() % 6) {
        case 0: now_ += kMicrosecond * in_.take<std::uint16_t>(); break;
        case 1:
          source_.tick();
          if (source_.record() && source_.record()->to == 1) hear(source_.record()->bytes);
          break;
        case 2: ask(client_.poll(now_)); break;
        case 3: {
          RdtRecord record;
          record.rdt_sequence = last_ + static_cast<std::uint32_t>(in_.take<std::int16_t>());
          record.counts.fill(in_.take<std::int32_t>());
          hear(encode_rdt(record));
          break;
        }
        case 4: {
          const fuzz::Bytes part = in_.take_bytes(in_.take<std::uint8_t>() % 64);
          check_rdt_codec(part);
          source_.on_datagram(part, 2);
          hear(part);
          break;
        }
        default: ask(in_.take<std::uint8_t>() % 2 == 0 ? client_.bias() : client_.stop());
      }
    }
  }

 private:
  static constexpr int kMostActs = 300;

  void ask(RdtClient::Bytes bytes) {
    if (!bytes.empty()) source_.on_datagram(bytes, 1);
  }
  // Never a record twice, and none from before but of a stream that began anew.
  void hear(fuzz::Bytes bytes) {
    FtSample sample;
    const RdtCounters before = client_.counters();
    const bool taken = client_.on_datagram(bytes, now_, sample);
    const RdtCounters& after = client_.counters();
    require(after.records - before.records + after.stale - before.stale + after.rejected -
                    before.rejected ==
                1,
            "every datagram is counted once");
    if (!taken) return;
    const auto ahead = static_cast<std::int32_t>(sample.sequence - last_);
    const bool anew = after.requests != requests_ || requests_ == 0;
    require(anew || ahead > 0 || ahead <= -1000, "records are taken in order");
    require(is_finite(sample.wrench), "a reading is a number");
    last_ = sample.sequence;
    requests_ = after.requests;
  }

  fuzz::Input in_;
  Nanos now_ = kSecond;
  RdtClient client_{RdtClientOptions{}};
  FtSource source_{FtSourceOptions{}};
  std::uint32_t last_ = 0;
  std::uint64_t requests_ = 0;
};

}  // namespace

HANDRAIL_FUZZ(rdt) {
  check_rdt_codec(bytes);
  RdtStream(bytes).run();
}

}  // namespace handrail
