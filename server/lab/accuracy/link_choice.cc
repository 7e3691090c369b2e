#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <vector>

#include "devices/hand/min_jerk.h"
#include "server/base/units.h"
#include "server/lab/accuracy/choices.h"
#include "server/lab/cell/wire.h"
#include "server/lab/scenes/contest.h"
#include "server/link/codec.h"

namespace handrail {
namespace {

constexpr Nanos kCycle = 7'100'000;     // of the robot's controller [ns]
constexpr double kTipWay = 75.0 * kMm;  // of the tip [m]
constexpr double kTime = 1.8;           // [s]
constexpr int kLinkCalls = 4;

MasterState command_at(Nanos t) {
  static const MinJerk move(VectorMotion(), Vec3(0.0, -kTipWay, 0.0), kTime);
  MasterState state;
  state.X_SU.p = Vec3(0.35, 0.0375, 0.329) + move.at(to_seconds(t)).p;
  return state;
}

// Over the phases that sender and receiver can have.
ErrorSum error_at(double rate) {
  constexpr int kPhases = 16;
  const Nanos period = std::llround(1e9 / rate);
  ErrorSum sum;
  for (int phase = 0; phase < kPhases; ++phase) {
    Wire<MasterState> wire(0, period);
    MasterState held = command_at(0);
    Nanos next = period * phase / kPhases;
    for (Nanos cycle = kCycle; to_seconds(cycle) < kTime; cycle += kCycle) {
      for (; next <= cycle; next += period) wire.send(command_at(next), next);
      wire.receive(cycle, held);
      sum.add((held.X_SU.p - command_at(cycle).X_SU.p).norm());
    }
  }
  return sum;
}

// One datagram through the codec and back.
struct Exchange {
  Codec codec;
  DatagramHeader header;
  MasterState state;
  std::array<std::uint8_t, kMaxDatagram> bytes{};
  std::size_t size = 0;

  bool run() {
    ++header.sequence;
    Reject cause = Reject::kNone;
    size = codec.encode(header, state, bytes, cause);
    MasterState received;
    DatagramHeader said;
    return codec.decode({bytes.data(), size}, said, received) == Reject::kNone;
  }
};

}  // namespace

AccuracyRows link_rows(const std::atomic<bool>& cancelled) {
  constexpr std::size_t kOverhead = 28;  // of IP and UDP [bytes]
  Exchange exchange;
  exchange.header.session = 1;
  exchange.state = command_at(kSecond);
  exchange.state.has_command = true;
  if (!exchange.run()) return {};
  Contest contest;
  contest.add([] {},
              [&] {
                for (int i = 0; i < kLinkCalls; ++i) keep(exchange.run());
              },
              kLinkCalls);
  contest.run(40, 128, cancelled);
  const Contest::Time time = contest.time(0);
  AccuracyRows rows;
  for (const double rate : {25.0, 50.0, 100.0, 141.0, 250.0, 500.0, 1000.0, 2000.0}) {
    AccuracyRow row;
    row.choice = "link_rate";
    row.method = "newest held";
    row.setting = fmt::format("{:g} Hz", rate);
    row.error = error_at(rate).in("um", 1e6);
    row.cost = {"us/s", time.median * rate * 1e-3, time.p999 * rate * 1e-3};
    row.memory_bytes = exchange.size;
    row.note =
        fmt::format("{:.1f} kB/s", rate * 1e-3 * static_cast<double>(exchange.size + kOverhead));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace handrail
