#include "devices/spacemouse/spnav_stream.h"

#include <algorithm>
#include <cstring>

namespace handrail {
namespace {

// The first word of a record. Above these are answers, to requests that we do not make.
enum SpnavEvent : std::int32_t {
  kMotionEvent = 0,
  kPressEvent = 1,
  kReleaseEvent = 2,
  kDeviceEvent = 3,
  kConfigEvent = 4,
  kRawAxisEvent = 5,
  kRawButtonEvent = 6,
};
constexpr std::int32_t kDeviceAdded = 0;  // second word of a device event
constexpr std::int32_t kDeviceRemoved = 1;
constexpr std::int32_t kMostButtons = 32;

}  // namespace

bool SpnavStream::take(std::span<const std::uint8_t> bytes) noexcept {
  while (!bad_ && !bytes.empty()) {
    const std::size_t wanted =
        length_ < sizeof(std::uint32_t) ? sizeof(std::uint32_t) : kSpnavRecord;
    const std::size_t n = std::min(wanted - length_, bytes.size());
    std::copy_n(bytes.data(), n, part_.data() + length_);
    length_ += n;
    bytes = bytes.subspan(n);
    if (length_ == sizeof(std::uint32_t)) bad_ = !take_word();
    if (length_ == kSpnavRecord) bad_ = !take_record();
  }
  return !bad_;
}

// The daemon's answer about the protocol is a word alone, and may come after events.
bool SpnavStream::take_word() noexcept {
  std::uint32_t word = 0;
  std::memcpy(&word, part_.data(), sizeof word);
  if ((word & ~0xffu) != kSpnavProtocol) return word <= kRawButtonEvent;
  protocol_ = static_cast<int>(word & 0xffu);
  length_ = 0;
  return true;
}

bool SpnavStream::take_record() noexcept {
  std::array<std::int32_t, kSpnavRecord / sizeof(std::int32_t)> data{};
  std::memcpy(data.data(), part_.data(), kSpnavRecord);
  length_ = 0;
  switch (data[0]) {
    case kMotionEvent:
      std::copy_n(data.begin() + 1, state_.counts.size(), state_.counts.begin());
      ++state_.motions;
      state_.unplugged = false;
      return true;
    case kPressEvent:
    case kReleaseEvent: {
      if (data[1] < 0) return false;
      state_.unplugged = false;
      if (data[1] >= kMostButtons) return true;
      const std::uint32_t bit = 1u << data[1];
      state_.buttons = data[0] == kPressEvent ? state_.buttons | bit : state_.buttons & ~bit;
      return true;
    }
    case kDeviceEvent:
      if (data[1] != kDeviceAdded && data[1] != kDeviceRemoved) return false;
      // Nobody pushes what was taken away, and what comes is not pushed yet.
      state_.counts = {};
      state_.buttons = 0;
      state_.unplugged = data[1] == kDeviceRemoved;
      return true;
    default: return data[0] >= kConfigEvent && data[0] <= kRawButtonEvent;
  }
}

}  // namespace handrail
