#include "devices/comedi/jr3_source.h"

#include <cerrno>
#include <cmath>
#include <cstdio>

#include "server/base/clock.h"

namespace handrail {
namespace {

constexpr char kJr3Driver[] = "jr3_pci";
// Changing its scales blanks the card's data for 4 ms.
constexpr Nanos kJr3Blank = 10 * kMillisecond;
constexpr Nanos kNotYetPause = 50 * kMillisecond;
// What a scale of a real sensor lies between, of force and of moment: one outside is none.
constexpr double kLeastFull = 0.1, kMostFull = 1e5;  // [N], [N m]

}  // namespace

Status Jr3Source::open(const ComediApi& api) {
  api_ = &api;
  reads_ = false;
  return open_card();
}

Status Jr3Source::open_card() {
  card_.reset();
  auto card = ComediCard::open(*api_, options_.place);
  if (!card) return card.status();
  if (card->driver() != kJr3Driver) {
    return card->error("is '" + card->board() + "', driven by " + card->driver() +
                       ", expected one of jr3_pci; name the card of JR3 in "
                       "force_sensor.comedi.device, or take kind: ANALOG");
  }
  constexpr int kInputs[] = {kComediAnalogIn};
  const auto subdevice = card->subdevice("force sensor", options_.subdevice, kInputs);
  if (!subdevice) return subdevice.status();
  for (unsigned int i = 0; i < channels_.size(); ++i) {
    channels_[i] = {*subdevice, jr3_channel(options_.filter, i), 0, 0};
  }
  card_ = std::move(*card);
  pacer_.emplace(static_cast<Nanos>(1e9 / options_.rate), monotonic_now());
  return ask_ranges();
}

Status Jr3Source::ask_ranges() {
  for (unsigned int i = 0; i < channels_.size(); ++i) {
    const auto range = card_->range(channels_[i]);
    if (!range) return range.status();
    full_scale_[i] = jr3_full_scale(*range);
    if (full_scale_[i] >= kLeastFull && full_scale_[i] <= kMostFull) continue;
    return card_->error("its full scale of axis " + std::to_string(i) + " is " +
                        std::to_string(full_scale_[i]) +
                        ", expected 0.1 to 100000 N or N m; is a sensor of JR3 plugged in?");
  }
  return Status::ok();
}

void Jr3Source::close() noexcept { card_.reset(); }

FtTaken Jr3Source::take(FtReading& out, std::uint32_t& periods) noexcept {
  if (!card_) return FtTaken::kLost;
  sleep_until(pacer_->due());
  periods = 1 + static_cast<std::uint32_t>(pacer_->woke(monotonic_now()));
  FtCounts raw{};
  const int error = card_->read(channels_, raw);
  if (error == EAGAIN || error == EINTR) {
    reads_ = false;
    sleep_until(monotonic_now() + kNotYetPause);
    return FtTaken::kNotYet;
  }
  if (error != 0) return FtTaken::kLost;
  if (!reads_) {
    if (!open_card()) return FtTaken::kLost;
    reads_ = true;
    return FtTaken::kNotYet;
  }
  out = jr3_reading(raw, full_scale_);
  return FtTaken::kReading;
}

Nanos Jr3Source::settling() const noexcept {
  return kJr3Blank + settling_time(kJr3Cutoffs[options_.filter]);
}

std::string Jr3Source::text() const {
  if (!card_) return "closed";
  std::array<char, 160> out{};
  const FtSix& f = full_scale_;
  std::snprintf(out.data(), out.size(),
                "%s, full scale %.4g, %.4g, %.4g N and %.4g, %.4g, %.4g N m",
                card_->board().c_str(), f[0], f[1], f[2], f[3], f[4], f[5]);
  return out.data();
}

std::pair<double, double> Jr3Source::full_scale() const noexcept {
  if (!reads_) return {0.0, 0.0};
  return {full_scale_.head<3>().minCoeff(), full_scale_.tail<3>().minCoeff()};
}

}  // namespace handrail
