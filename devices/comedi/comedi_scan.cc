#include "devices/comedi/comedi_scan.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr int kScanPatience = 100;  // [ms]
constexpr double kSameRate = 0.01;  // of the period: cards divide a clock

}  // namespace

std::size_t ComediScanBytes::take(std::span<const std::uint8_t> bytes) noexcept {
  std::size_t scans = 0;
  const std::size_t whole = channels_ * bytes_each_;
  while (!bytes.empty()) {
    const std::size_t n = std::min(bytes.size(), whole - have_);
    std::copy_n(bytes.begin(), n, part_.begin() + static_cast<std::ptrdiff_t>(have_));
    bytes = bytes.subspan(n);
    have_ += n;
    if (have_ < whole) break;
    have_ = 0;
    ++scans;
    for (std::size_t i = 0; i < channels_; ++i) {
      std::uint32_t value = 0;  // x86 and arm64 alike have the low byte first
      std::memcpy(&value, part_.data() + i * bytes_each_, bytes_each_);
      newest_[i] = value;
    }
  }
  return scans;
}

ComediScan::ComediScan(ComediCard& card, unsigned int subdevice, std::size_t channels,
                       std::size_t bytes_each)
    : card_(&card), subdevice_(subdevice), bytes_(channels, bytes_each) {}

ComediScan::ComediScan(ComediScan&& other) noexcept
    : card_(std::exchange(other.card_, nullptr)),
      subdevice_(other.subdevice_),
      bytes_(other.bytes_) {}

ComediScan::~ComediScan() {
  if (card_ != nullptr) card_->api().cancel(card_->handle(), subdevice_);
}

Result<ComediScan> ComediScan::start(ComediCard& card, std::span<const ComediChannel> channels,
                                     double rate) {
  const ComediApi& api = card.api();
  std::array<unsigned int, kMostComediChannels> list{};
  const auto count = static_cast<unsigned int>(std::min(channels.size(), list.size()));
  if (count == 0) return card.error("streams no channels, as none were asked for");
  for (std::size_t i = 0; i < count; ++i) list[i] = channels[i].spec();
  ComediCommand command;
  command.subdev = channels[0].subdevice;
  command.flags = kComediWakeEachScan;
  command.start_src = kComediNow;
  command.scan_begin_src = kComediTimer;
  const double period = std::round(1e9 / rate);
  command.scan_begin_arg = static_cast<unsigned int>(period);
  command.convert_src = kComediTimer;
  // As far apart as the scan has room for, half of it; the card makes it what it can do.
  command.convert_arg = command.scan_begin_arg / (2 * count);
  command.scan_end_src = kComediCount;
  command.scan_end_arg = count;
  command.stop_src = kComediNever;
  command.chanlist = list.data();
  command.chanlist_len = count;
  // The card mends what it cannot do, a step at a time (comedi_command_test, four steps).
  int answer = 0;
  for (int i = 0; i < 5; ++i) {
    answer = api.command_test(card.handle(), &command);
    if (answer == 0) break;
    if (answer <= 2 && command.convert_src != kComediNow) command.convert_src = kComediNow;
    if (command.convert_src == kComediNow) command.convert_arg = 0;
  }
  const double real = command.scan_begin_arg;
  if (answer != 0 || std::abs(real - period) > kSameRate * period) {
    return card.error("does not stream " + std::to_string(count) + " channels at " +
                      number_text(rate) + " Hz" +
                      (answer == 0 ? ", but at " + number_text(1e9 / real) + " Hz" : "") +
                      "; another force_sensor.comedi.rate_hz");
  }
  if (api.command(card.handle(), &command) < 0) {
    const int error = errno;
    const std::string hint = comedi_hint(error);
    return card.error(std::string("its stream does not start: ") + std::strerror(error) +
                      (hint.empty() ? "" : "; " + hint));
  }
  const int fd = api.file(card.handle());
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
  const bool wide = (api.flags(card.handle(), command.subdev) & kComediLongSamples) != 0;
  return ComediScan(card, command.subdev, count, wide ? 4 : 2);
}

ComediScan::Outcome ComediScan::take(std::uint32_t& scans) noexcept {
  scans = 0;
  const int fd = card_->api().file(card_->handle());
  pollfd ready{fd, POLLIN, 0};
  if (::poll(&ready, 1, kScanPatience) <= 0) return Outcome::kNothing;
  std::array<std::uint8_t, 4096> bytes;
  for (;;) {
    const ssize_t n = ::read(fd, bytes.data(), bytes.size());
    if (n > 0) {
      scans += static_cast<std::uint32_t>(
          bytes_.take(std::span(bytes).first(static_cast<std::size_t>(n))));
      if (static_cast<std::size_t>(n) == bytes.size()) continue;
      return scans > 0 ? Outcome::kScans : Outcome::kNothing;
    }
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) {
      return scans > 0 ? Outcome::kScans : Outcome::kNothing;
    }
    // The end of the stream, or the error that ended it.
    return n < 0 && errno != EPIPE ? Outcome::kLost : Outcome::kOverrun;
  }
}

}  // namespace handrail
