// What the kernel tells of an input device, from bytes. No file.
//
// Source: Linux, include/uapi/linux/input.h and Documentation/input/event-codes.rst.
#pragma once

#include <linux/input.h>

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>

namespace handrail {

// Where keys and axes are, by the kernel's codes.
struct EvdevState {
  std::bitset<KEY_CNT> keys;                 // down
  std::array<std::int32_t, ABS_CNT> axes{};  // in the device's counts
};

// Takes the stream apart, however it is cut. Real-time safe.
class EvdevStream {
 public:
  // From here on the stream goes on from this state.
  void begin(const EvdevState& state) noexcept;
  // False where the kernel had no room and events are missing: the state is not known until
  // begin().
  bool take(std::span<const std::uint8_t> bytes) noexcept;

  // As of the last whole report.
  const EvdevState& state() const noexcept { return state_; }
  // Keys that went down since this was asked last, whether or not they are up again.
  std::bitset<KEY_CNT> take_presses() noexcept;

 private:
  bool take_event() noexcept;

  std::array<std::uint8_t, sizeof(input_event)> part_{};
  std::size_t length_ = 0;  // of part_
  EvdevState state_;
  EvdevState coming_;  // of the report that is not whole yet
  std::bitset<KEY_CNT> presses_;
  bool dropped_ = false;
};

}  // namespace handrail
