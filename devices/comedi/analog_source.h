// Six voltages of a force sensor without a card of its own.
#pragma once

#include <optional>
#include <string>

#include "devices/comedi/comedi_scan.h"
#include "devices/comedi/ft_source.h"
#include "server/base/pacer.h"

namespace handrail {

// A card that streams is told the rate, and converts by its own clock; another is asked each
// period.
class AnalogSource final : public ComediFtSource {
 public:
  explicit AnalogSource(const ComediFtOptions& options) : options_(options) {}

  Status open(const ComediApi& api) override;
  void close() noexcept override;
  FtTaken take(FtReading& out, std::uint32_t& periods) noexcept override;
  Nanos settling() const noexcept override { return 0; }
  std::string text() const override;

  // The newest voltages [V].
  const FtSix& volts() const noexcept { return volts_; }
  // Scans that the card had no room for, since it was opened first.
  std::uint64_t overruns() const noexcept { return overruns_; }

 private:
  FtTaken ask(FtCounts& raw, std::uint32_t& periods) noexcept;
  FtTaken stream(FtCounts& raw, std::uint32_t& periods) noexcept;

  ComediFtOptions options_;
  std::optional<ComediCard> card_;
  std::array<ComediChannel, 6> channels_;
  std::array<ComediRange, 6> ranges_;
  std::array<unsigned int, 6> max_data_{};
  std::optional<ComediScan> scan_;  // it streams
  std::optional<Pacer> pacer_;      // it is asked
  FtSix volts_ = FtSix::Zero();
  std::uint64_t overruns_ = 0;
};

}  // namespace handrail
