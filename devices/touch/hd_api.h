// The part of 3D Systems' libHD that is used, as its binary interface. Nothing of the vendor's is
// needed to compile this.
//
// Source: OpenHaptics Toolkit API reference and hdDefines.h, as public drivers cite them
// (sawSensablePhantom, Geomagic_Touch_ROS_Drivers).
#pragma once

#include <cstdint>
#include <string>

#include "server/base/status.h"

namespace handrail {

using HdHandle = std::uint32_t;
using HdEnum = std::uint32_t;
using HdCallback = std::uint32_t (*)(void*);

inline constexpr HdHandle kHdNoDevice = 0xffffffff;
inline constexpr std::uint32_t kHdDone = 0, kHdContinue = 1;  // what a callback returns
inline constexpr std::uint16_t kHdHighestPriority = 65535;

// What is asked for.
inline constexpr HdEnum kHdButtons = 0x2000, kHdEncoders = 0x2010, kHdVelocity = 0x2051,
                        kHdTransform = 0x2052;
inline constexpr HdEnum kHdModel = 0x2501, kHdDriverVersion = 0x2502, kHdVendor = 0x2503,
                        kHdSerial = 0x2504;
inline constexpr HdEnum kHdInputDof = 0x2553, kHdCalibrationStyle = 0x2555;
inline constexpr HdEnum kHdNominalMaxForce = 0x2603, kHdContinuousForce = 0x2604,
                        kHdMotorTemperature = 0x2605;
inline constexpr HdEnum kHdCurrentForce = 0x2700;
inline constexpr HdEnum kHdForceOutput = 0x4000;
// What hdCheckCalibration answers, and the ways to calibrate, as bits.
inline constexpr HdEnum kHdCalibrated = 0x5000, kHdNeedsUpdate = 0x5001, kHdNeedsManual = 0x5002;
inline constexpr HdEnum kHdEncoderReset = 1, kHdAuto = 2, kHdInkwell = 4;
// Errors.
inline constexpr std::uint32_t kHdSuccess = 0, kHdInvalidOperation = 0x102, kHdWarmMotors = 0x200,
                               kHdExceededForce = 0x201, kHdExceededImpulse = 0x202,
                               kHdExceededVelocity = 0x203, kHdForceError = 0x204,
                               kHdDeviceFault = 0x300, kHdAlreadyInitiated = 0x301,
                               kHdCommError = 0x302, kHdCommConfigError = 0x303,
                               kHdTimerError = 0x304, kHdInvalidLicense = 0x600;

// Returned by value.
struct HdError {
  std::uint32_t code = kHdSuccess;
  int internal = 0;  // the vendor's own number
  HdHandle device = 0;
};

// The functions; none is null in one that was loaded. hdGetError takes the newest error off a
// stack, kHdSuccess where that is empty.
struct HdApi {
  HdHandle (*init_device)(const char* name) = nullptr;
  void (*disable_device)(HdHandle) = nullptr;
  void (*make_current)(HdHandle) = nullptr;
  void (*begin_frame)(HdHandle) = nullptr;
  void (*end_frame)(HdHandle) = nullptr;
  HdError (*get_error)() = nullptr;
  const char* (*error_string)(std::uint32_t) = nullptr;
  void (*enable)(HdEnum) = nullptr;
  void (*disable)(HdEnum) = nullptr;
  void (*get_integer)(HdEnum, std::int32_t*) = nullptr;
  void (*get_double)(HdEnum, double*) = nullptr;
  const char* (*get_string)(HdEnum) = nullptr;
  void (*set_double)(HdEnum, const double*) = nullptr;
  HdEnum (*check_calibration)() = nullptr;
  void (*update_calibration)(HdEnum style) = nullptr;
  void (*start_scheduler)() = nullptr;
  void (*stop_scheduler)() = nullptr;
  void (*set_rate)(unsigned long) = nullptr;
  unsigned long (*schedule)(HdCallback, void*, std::uint16_t priority) = nullptr;
  void (*unschedule)(unsigned long) = nullptr;
};

// Loads `library`, a path or a name that the loader knows. It stays loaded: the vendor's has
// threads of its own. The error names the library and the cause, or the function that it has not,
// and what to do.
Result<HdApi> load_hd(const std::string& library);

// What a person can do about an error; empty: nothing is known.
const char* hd_hint(std::uint32_t code) noexcept;

// "communication error (0x302, internal 7)", in the vendor's words.
std::string hd_error_text(const HdApi& api, const HdError& error);

}  // namespace handrail
