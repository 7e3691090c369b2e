#include "devices/evdev/evdev_stream.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace handrail {

void EvdevStream::begin(const EvdevState& state) noexcept {
  *this = EvdevStream();
  state_ = coming_ = state;
}

bool EvdevStream::take(std::span<const std::uint8_t> bytes) noexcept {
  while (!dropped_ && !bytes.empty()) {
    const std::size_t n = std::min(part_.size() - length_, bytes.size());
    std::copy_n(bytes.data(), n, part_.data() + length_);
    length_ += n;
    bytes = bytes.subspan(n);
    if (length_ == part_.size()) dropped_ = !take_event();
  }
  return !dropped_;
}

bool EvdevStream::take_event() noexcept {
  input_event event{};
  std::memcpy(&event, part_.data(), part_.size());
  length_ = 0;
  switch (event.type) {
    case EV_SYN:
      if (event.code == SYN_DROPPED) return false;
      if (event.code == SYN_REPORT) state_ = coming_;
      return true;
    case EV_KEY:
      if (event.code >= KEY_CNT) return true;
      // 2 is the kernel's own repeating of a key that is held.
      coming_.keys[event.code] = event.value != 0;
      if (event.value == 1) presses_[event.code] = true;
      return true;
    case EV_ABS:
      if (event.code < ABS_CNT) coming_.axes[event.code] = event.value;
      return true;
    default: return true;
  }
}

std::bitset<KEY_CNT> EvdevStream::take_presses() noexcept {
  return std::exchange(presses_, std::bitset<KEY_CNT>());
}

}  // namespace handrail
