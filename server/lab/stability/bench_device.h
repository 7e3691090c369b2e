// The devices that walls are tried on, without the operators that drive them elsewhere.
#pragma once

#include <array>

#include "devices/haptic_device.h"
#include "server/lab/stability/bare_device.h"

namespace handrail {

// As good as none: a device whose counts are 0 counts as one that does not say [m].
inline constexpr double kFinest = 1e-9;

enum class GripKind : std::uint8_t { kNone, kLight, kFirm };

inline constexpr std::array kGripKinds = {GripKind::kNone, GripKind::kLight, GripKind::kFirm};

struct BenchDevice {
  const char* name = "";
  HapticCapabilities capabilities;
  double cutoff = 0.0;   // of the velocity that its driver gives [Hz]; 0: the bare difference
  double lean = 0.0;     // what presses it against a wall, below its sustained force [N]
  double damping = 0.0;  // of a wall where damping is tried [N s/m]
  PassiveGrip light, firm;

  // As its data declare it.
  DeviceBody body() const;
  PassiveGrip grip(GripKind kind) const;
};

const char* name_of(GripKind kind);

// The passive part of a stylus grip of that stiffness [N/m]; published are kLightest to kFirmest
// (Fu and Cavusoglu 2012).
inline constexpr double kLightest = 50.0, kFirmest = 500.0;
PassiveGrip stylus_grip(double stiffness);

// Omni and joystick as their data say, and a linear axis that has viscous damping alone.
const std::array<BenchDevice, 3>& bench_devices();

}  // namespace handrail
