#include "devices/melfa/mxt_gripper.h"

#include <algorithm>

namespace handrail {
namespace {

std::uint16_t first(const MxtGripper& gripper) {
  return std::min(gripper.close, gripper.open.value_or(gripper.close));
}

std::uint16_t bit(const MxtGripper& gripper, std::uint16_t output) {
  return static_cast<std::uint16_t>(1u << (output - first(gripper)));
}

}  // namespace

MxtIo io_of(const MxtGripper& gripper, Grip wanted) noexcept {
  MxtIo io;
  io.send_type = io.recv_type = kMxtOutputs;
  io.bit_top = first(gripper);
  if (wanted != Grip::kClosed && wanted != Grip::kOpen) return io;
  const std::uint16_t close = bit(gripper, gripper.close);
  const std::uint16_t open = gripper.open ? bit(gripper, *gripper.open) : std::uint16_t{0};
  io.bit_mask = static_cast<std::uint16_t>(close | open);
  io.data = wanted == Grip::kClosed ? close : open;
  return io;
}

std::optional<GripperState> state_of(const MxtGripper& gripper, const MxtIo& io) noexcept {
  if (io.send_type != kMxtOutputs || io.bit_top != first(gripper)) return std::nullopt;
  const bool close = (io.data & bit(gripper, gripper.close)) != 0;
  const bool open = gripper.open ? (io.data & bit(gripper, *gripper.open)) != 0 : !close;
  if (close == open) return GripperState::kBetween;
  return close ? GripperState::kClosed : GripperState::kOpen;
}

}  // namespace handrail
