// A simulated force/torque sensor that streams ATI Net F/T records.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/net_ft/rdt_packet.h"
#include "devices/rig/network.h"
#include "server/base/random.h"
#include "server/base/spatial.h"
#include "server/base/time.h"

namespace handrail {

struct FtSourceOptions {
  std::uint64_t seed = 1;
  Nanos period = kMillisecond;  // > 0
  double counts_per_n = 1e6;    // > 0
  double counts_per_n_m = 1e6;  // > 0
  double range_n = 1000.0;      // |force| per axis [N]
  double range_n_m = 100.0;     // |torque| per axis [N m]
  double noise_n = 0.05;        // RMS per axis, white [N]
  double noise_n_m = 0.0025;    // RMS per axis, white [N m]
  double drift_n_per_s = 0.0;   // RMS change of a force axis' zero in a second; 0: none [N]
  double drift_n = 0.0;         // RMS of the zero in the long run [N]
  Wrench zero;                  // read without a force, to begin with; of the torque for good
  double step_n = 0.0;          // smallest step of a reading; 0: the counts' own [N]
  double step_n_m = 0.0;        // [N m]
  double drop_share = 0.0;      // share of packets lost, each way, 0 to 1
};

// Streams to whoever asked last, one record a period, from the period after the request. A bias
// request takes the present wrench, without its noise, as zero from the next record on; the range
// is the transducer's, before the bias. The zeros of the force axes wander from where they begin as
// an Ornstein-Uhlenbeck process around 0, exact for any period. Time and bytes are arguments; all
// calls are real-time safe.
class FtSource {
 public:
  struct Outgoing {
    PeerId to = 0;
    std::array<std::uint8_t, kRdtRecordSize> bytes{};
  };

  explicit FtSource(const FtSourceOptions& options) noexcept;

  // What the environment exerts on the sensor, in the sensor's frame. Non-finite reads as
  // saturated.
  void set_wrench(const Wrench& wrench) noexcept { wrench_ = wrench; }
  void on_datagram(std::span<const std::uint8_t> bytes, PeerId from) noexcept;
  // One sampling period.
  void tick() noexcept;
  // The record this period sent, if any; holds until the next.
  const std::optional<Outgoing>& record() const noexcept { return outgoing_; }

  std::optional<PeerId> listener() const noexcept { return listener_; }
  // Datagrams that were no request.
  std::uint64_t ignored() const noexcept { return ignored_; }
  const LossySwitch& network() const noexcept { return switch_; }

 private:
  void drift() noexcept;

  FtSourceOptions options_;
  Random random_;
  Random drift_random_;
  LossySwitch switch_;
  Wrench wrench_;
  Wrench bias_;
  Vec3 zero_;                 // of the force, now
  double drift_left_ = 1.0;   // of a zero after a period
  double drift_added_ = 0.0;  // RMS in a period [N]
  std::optional<PeerId> listener_;
  std::uint32_t samples_left_ = 0;  // 0: without end
  std::uint32_t rdt_sequence_ = 0;
  std::uint32_t ft_sequence_ = 0;
  std::optional<Outgoing> outgoing_;
  std::uint64_t ignored_ = 0;
};

}  // namespace handrail
