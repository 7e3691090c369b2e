// A JR3 at its own card.
#pragma once

#include <optional>
#include <string>

#include "devices/comedi/ft_source.h"
#include "server/base/pacer.h"

namespace handrail {

// The kernel's jr3_pci answers EAGAIN for about 12 s after it was loaded, while it finds the
// sensor's offsets, and whenever the sensor is changed or silent. What range its channels have is
// known only then, and libcomedi asks for it as it opens the device: so this opens it anew when the
// readings begin.
class Jr3Source final : public ComediFtSource {
 public:
  explicit Jr3Source(const ComediFtOptions& options) : options_(options) {}

  Status open(const ComediApi& api) override;
  void close() noexcept override;
  FtTaken take(FtReading& out, std::uint32_t& periods) noexcept override;
  Nanos settling() const noexcept override;
  std::string text() const override;
  std::pair<double, double> full_scale() const noexcept override;

 private:
  Status open_card();
  Status ask_ranges();

  ComediFtOptions options_;
  const ComediApi* api_ = nullptr;
  std::optional<ComediCard> card_;
  std::array<ComediChannel, 6> channels_;
  FtSix full_scale_ = FtSix::Zero();  // [N], [N m]
  bool reads_ = false;                // the ranges are those of the sensor
  std::optional<Pacer> pacer_;
};

}  // namespace handrail
