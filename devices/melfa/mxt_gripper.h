// A gripper behind the digital outputs that a MELFA packet sets and reads back.
#pragma once

#include <cstdint>
#include <optional>

#include "devices/melfa/mxt_packet.h"
#include "server/model/gripper.h"

namespace handrail {

// Numbers of the controller's outputs; those of its hand begin at 900. One valve that springs back
// has `close` alone, which is off to open; one with two coils has both, in one word of 16.
struct MxtGripper {
  std::uint16_t close = 900;
  std::optional<std::uint16_t> open;
};

// What every packet says of the outputs: those of the gripper as they are to be, and that all
// sixteen from the lower one on are to be read back. Other outputs are left alone. Real-time safe.
MxtIo io_of(const MxtGripper& gripper, Grip wanted) noexcept;

// What a reply's outputs say; none where it holds others, or inputs. Real-time safe.
std::optional<GripperState> state_of(const MxtGripper& gripper, const MxtIo& io) noexcept;

}  // namespace handrail
