#include "server/lab/network/link_faults.h"

#include <array>

namespace handrail {
namespace {

LinkFaults later(int delay_ms, int jitter_ms) {
  LinkFaults out;
  out.delay = delay_ms * kMillisecond;
  out.jitter = jitter_ms * kMillisecond;
  return out;
}

// A link over the open internet with a broker between: delay and jitter of a good one to another
// continent, loss of a bad one.
LinkFaults far_away() {
  LinkFaults out = later(50, 20);
  out.loss = 0.1;
  return out;
}

// 5 % lost, in bursts of 10 datagrams on average.
LinkFaults bursts() {
  LinkFaults out = later(10, 2);
  out.burst_leave = 0.1;
  out.burst_enter = 0.05 / 0.95 * out.burst_leave;
  return out;
}

// Source: the simulator that the tests of netcode 1.4, a protocol for games, run with.
LinkFaults netcode() {
  LinkFaults out = later(250, 250);
  out.loss = 0.05;
  out.duplicate = 0.1;
  out.reorder = 1.0;
  return out;
}

// Source: the same tests' harsher one.
LinkFaults harsh() {
  LinkFaults out = later(100, 50);
  out.loss = 0.25;
  out.duplicate = 0.25;
  out.reorder = 1.0;
  return out;
}

// A line that anything fills, with a queue of a second before it.
LinkFaults narrow() {
  LinkFaults out;
  out.rate_bps = 256'000;
  return out;
}

}  // namespace

std::span<const KnownNetwork> known_networks() {
  static const std::array<KnownNetwork, 6> all = {{
      {"clear", "does nothing", {}},
      {"far", "50 +- 20 ms, 10 % lost", far_away()},
      {"bursts", "10 +- 2 ms, 5 % lost in bursts of 10", bursts()},
      {"netcode", "250 +- 250 ms out of order, 5 % lost, 10 % twice", netcode()},
      {"harsh", "100 +- 50 ms out of order, 25 % lost, 25 % twice", harsh()},
      {"narrow", "256 kbit/s behind a queue of 1 s", narrow()},
  }};
  return all;
}

const KnownNetwork* find_network(std::string_view name) {
  for (const KnownNetwork& network : known_networks()) {
    if (network.name == name) return &network;
  }
  return nullptr;
}

}  // namespace handrail
