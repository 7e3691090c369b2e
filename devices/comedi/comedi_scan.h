// A card that converts the same channels again and again by its own clock.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "devices/comedi/comedi_card.h"

namespace handrail {

// What came from a card that streams: whole scans, and what is left of one.
class ComediScanBytes {
 public:
  // `channels` numbers a scan, of `bytes_each`, 2 or 4, as the processor has them.
  ComediScanBytes(std::size_t channels, std::size_t bytes_each)
      : channels_(channels), bytes_each_(bytes_each) {}

  // Adds bytes; returns how many scans they completed. Of these, newest() is the last.
  std::size_t take(std::span<const std::uint8_t> bytes) noexcept;
  std::span<const unsigned int> newest() const noexcept {
    return std::span(newest_).first(channels_);
  }

 private:
  std::size_t channels_, bytes_each_;
  std::size_t have_ = 0;  // bytes of the present scan
  std::array<std::uint8_t, 4 * kMostComediChannels> part_{};
  std::array<unsigned int, kMostComediChannels> newest_{};
};

// Used by one thread; `card` must outlive it.
class ComediScan {
 public:
  // Starts it. The error says what the card made of the rate.
  static Result<ComediScan> start(ComediCard& card, std::span<const ComediChannel> channels,
                                  double rate);
  ComediScan(ComediScan&& other) noexcept;
  ComediScan& operator=(ComediScan&&) = delete;
  ~ComediScan();

  enum class Outcome : std::uint8_t { kScans, kNothing, kOverrun, kLost };
  // Waits up to a tenth of a second for the next scans, and takes all that came. kOverrun: the
  // card's driver had no room for some, and the stream ended.
  Outcome take(std::uint32_t& scans) noexcept;
  std::span<const unsigned int> newest() const noexcept { return bytes_.newest(); }

 private:
  ComediScan(ComediCard& card, unsigned int subdevice, std::size_t channels,
             std::size_t bytes_each);

  ComediCard* card_;
  unsigned int subdevice_;
  ComediScanBytes bytes_;
};

}  // namespace handrail
