// A gripper that opens and closes by outputs of the robot's controller.
#pragma once

#include <cstdint>

namespace handrail {

// What is wanted of it. As it is: nothing; the controller keeps its outputs.
enum class Grip : std::uint8_t { kAsItIs, kClosed, kOpen, kCount };

// What the controller says of its outputs, which is not where the fingers are. Between: of two
// outputs both or neither is on. None: there is no gripper, or the controller has not said.
enum class GripperState : std::uint8_t { kNone, kClosed, kOpen, kBetween, kCount };

const char* name_of(GripperState state) noexcept;

// Whether the controller says that it is as wanted. Real-time safe.
constexpr bool is_as_wanted(Grip wanted, GripperState state) noexcept {
  return (wanted == Grip::kClosed && state == GripperState::kClosed) ||
         (wanted == Grip::kOpen && state == GripperState::kOpen);
}

}  // namespace handrail
