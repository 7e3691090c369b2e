// One datagram of the link, written and read, on seeded states.
#include <array>

#include "server/link/peer.h"
#include "tests/bench/percentile.h"
#include "tests/unit/link/link_samples.h"

namespace handrail::bench {
namespace {

// Encodes and decodes one datagram of the master.
struct MasterThereAndBack {
  Codec codec;
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  DatagramHeader header = sample_header();
  MasterState state = sample_master();
  MasterState* operator()() {
    Reject cause = Reject::kNone;
    ++header.sequence;
    const std::size_t size = codec.encode(header, state, bytes, cause);
    benchmark::DoNotOptimize(codec.decode(std::span(bytes).first(size), header, state));
    return &state;
  }
};

// A whole millisecond of both ends: each sends once and takes the other's.
struct BothEnds {
  MasterPeer master{1};
  SlavePeer slave{2};
  MasterState master_state = sample_master();
  SlaveState slave_state = sample_slave();
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  Nanos now = kSecond;
  const SlaveState* operator()() {
    now += kMillisecond;
    std::size_t size = master.poll(now, master_state, bytes);
    benchmark::DoNotOptimize(slave.on_datagram(std::span(bytes).first(size), now));
    size = slave.poll(now, slave_state, bytes);
    benchmark::DoNotOptimize(master.on_datagram(std::span(bytes).first(size), now));
    return &master.newest();
  }
};

void BM_LinkCodec(benchmark::State& state) {
  run(state, "link datagram, encode + decode", 1, 0.0, MasterThereAndBack{});
}
void BM_LinkBothEnds(benchmark::State& state) {
  run(state, "link, both ends of one millisecond", 1, 0.0, BothEnds{});
}
BENCHMARK(BM_LinkCodec);
BENCHMARK(BM_LinkBothEnds);

}  // namespace
}  // namespace handrail::bench
