// What the controller reports about the arm.
#pragma once

#include "devices/melfa/mxt_packet.h"
#include "devices/rig/servo_arm.h"

namespace handrail {

// The data block of `type` for the arm as it stands. Commanded values are the target in force; the
// controller has no filter, so filtered ones are the same. Poses are the tip's in mm and rad, with
// R = Rz(C) Ry(B) Rx(A); their structure flag has bit 2 right, bit 1 above, bit 0 non-flip
// (recalled from the field's habit, unverified). Pulses and currents are not simulated: zeros.
// Real-time safe.
MxtBlock monitor_block(MxtType type, const ServoArm& arm) noexcept;

}  // namespace handrail
