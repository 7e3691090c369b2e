// The computer's side of an RDT stream as a pure state machine.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/ft_sensor.h"
#include "devices/net_ft/rdt_packet.h"

namespace handrail {

struct RdtClientOptions {
  RdtDialect dialect = RdtDialect::kAti;
  // OnRobot's, told as the stream begins; none: as the sensor has it.
  std::optional<std::uint32_t> period_ms{};  // of the stream, > 0 [ms]
  std::optional<std::uint32_t> filter{};     // place in kRdtFilters
  double counts_per_n = 1e6;                 // > 0
  double counts_per_n_m = 1e6;               // > 0
  Nanos patience = 100 * kMillisecond;       // silence after which the stream is asked for again
};

struct RdtCounters {
  std::uint64_t records = 0;   // records given out
  std::uint64_t stale = 0;     // repeated or older than one already given
  std::uint64_t rejected = 0;  // of the wrong size
  std::uint64_t requests = 0;  // times the stream was asked for
};

// Spans returned point into the client and hold until its next call. All calls are real-time safe.
class RdtClient {
 public:
  using Bytes = std::span<const std::uint8_t>;

  explicit RdtClient(const RdtClientOptions& options) noexcept : options_(options) {}

  // What has to be sent before the request for a stream, each time: a sensor that was without power
  // has forgotten it. Request `i`, from 0 on; empty: there are no more.
  Bytes setting(int i) noexcept;
  // The request for an endless stream.
  Bytes start(Nanos now) noexcept;
  // True: `sample` is filled with a record newer than any given before, by the stream's sequence
  // number with wrap-around. A number 1000 or more behind is no late datagram but a sensor that
  // began its stream anew. Anything else is dropped and counted.
  bool on_datagram(Bytes bytes, Nanos now, FtSample& sample) noexcept;
  // The request again when nothing new has come for `patience`, else empty.
  Bytes poll(Nanos now) noexcept;
  // The request to take the present reading as zero.
  Bytes bias() noexcept;
  // The request to end the stream; poll() is quiet until the next start().
  Bytes stop() noexcept;

  const RdtCounters& counters() const noexcept { return counters_; }

 private:
  Bytes write(RdtCommand command, std::uint32_t value = 0) noexcept;

  RdtClientOptions options_;
  RdtCounters counters_;
  bool streaming_ = false;
  bool has_newest_ = false;
  std::uint32_t newest_ = 0;
  Nanos quiet_since_ = 0;
  std::array<std::uint8_t, kRdtRequestSize> buffer_{};
};

}  // namespace handrail
