#include "devices/comedi/analog_source.h"

#include <algorithm>
#include <cerrno>

#include "devices/comedi/jr3_source.h"
#include "server/base/clock.h"

namespace handrail {

Status AnalogSource::open(const ComediApi& api) {
  close();
  auto card = ComediCard::open(api, options_.place);
  if (!card) return card.status();
  constexpr int kInputs[] = {kComediAnalogIn};
  const auto subdevice = card->subdevice("force sensor", options_.subdevice, kInputs);
  if (!subdevice) return subdevice.status();
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    channels_[i] = {*subdevice, options_.channels[i], options_.range, options_.reference};
    const auto range = card->range(channels_[i]);
    if (!range) return range.status();
    if (range->unit != kComediVolt) {
      return card->error("channel " + std::to_string(options_.channels[i]) +
                         " is not in volts; another force_sensor.comedi.input_range");
    }
    ranges_[i] = *range;
    max_data_[i] = card->max_data(channels_[i]);
  }
  card_ = std::move(*card);
  if (card_->streams(*subdevice)) {
    auto scan = ComediScan::start(*card_, channels_, options_.rate);
    if (!scan) {
      card_.reset();
      return scan.status();
    }
    scan_.emplace(std::move(*scan));
  } else {
    pacer_.emplace(static_cast<Nanos>(1e9 / options_.rate), monotonic_now());
  }
  return Status::ok();
}

void AnalogSource::close() noexcept {
  scan_.reset();
  pacer_.reset();
  card_.reset();
}

FtTaken AnalogSource::ask(FtCounts& raw, std::uint32_t& periods) noexcept {
  sleep_until(pacer_->due());
  periods = 1 + static_cast<std::uint32_t>(pacer_->woke(monotonic_now()));
  const int error = card_->read(channels_, raw);
  if (error == EAGAIN || error == EINTR) return FtTaken::kNotYet;
  return error == 0 ? FtTaken::kReading : FtTaken::kLost;
}

FtTaken AnalogSource::stream(FtCounts& raw, std::uint32_t& periods) noexcept {
  switch (scan_->take(periods)) {
    case ComediScan::Outcome::kScans:
      std::copy_n(scan_->newest().begin(), raw.size(), raw.begin());
      return FtTaken::kReading;
    case ComediScan::Outcome::kNothing: return FtTaken::kNothing;
    case ComediScan::Outcome::kOverrun: ++overruns_; return FtTaken::kLost;
    case ComediScan::Outcome::kLost: break;
  }
  return FtTaken::kLost;
}

FtTaken AnalogSource::take(FtReading& out, std::uint32_t& periods) noexcept {
  if (!card_) return FtTaken::kLost;
  FtCounts raw{};
  const FtTaken taken = scan_ ? stream(raw, periods) : ask(raw, periods);
  if (taken != FtTaken::kReading) return taken;
  std::uint32_t at_end = 0;
  for (unsigned int i = 0; i < raw.size(); ++i) {
    volts_[i] = comedi_value(raw[i], ranges_[i], max_data_[i]);
    if (raw[i] == 0 || raw[i] >= max_data_[i]) at_end |= 1u << i;
  }
  out = analog_reading(volts_, at_end, options_.bias, options_.matrix);
  return taken;
}

std::string AnalogSource::text() const {
  if (!card_) return "closed";
  return card_->board() + ", driven by " + card_->driver() +
         (scan_ ? ", which streams" : ", which is asked each period");
}

std::unique_ptr<ComediFtSource> make_ft_source(const ComediFtOptions& options) {
  if (options.kind == ComediFtKind::kAnalog) return std::make_unique<AnalogSource>(options);
  return std::make_unique<Jr3Source>(options);
}

}  // namespace handrail
