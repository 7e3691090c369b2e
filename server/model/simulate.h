// What the simulated arm, sensor and workpiece do, as data. SI, robot base frame S unless the name
// says otherwise.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "server/base/joints.h"
#include "server/base/spatial.h"
#include "server/base/units.h"

namespace handrail {

struct ServoLagSpec {
  double lag = 0.045;    // nominal time constant of every joint; 0: none [s]
  double spread = 0.03;  // joints drawn within lag (1 +- spread)
};

struct EncoderOffsetsSpec {
  double repeatability = 4e-5;  // RMS at the tip [m]
};

struct BacklashSpec {
  JointVector play = JointVector::Zero();  // from end to end [rad]
};

struct GravitySpec {
  double mass = 0.0;                                       // of the payload [kg]
  Vec3 p_TC = Vec3::Zero();                                // its centre, from the tip, tip axes [m]
  JointVector stiffness = JointVector::Constant(20000.0);  // of the joints [N m/rad]
};

struct ArmComplianceSpec {
  double stiffness = 60e3;  // at the tip, every way [N/m]
};

// In the tip's axes, Z along the tool.
struct ToolComplianceSpec {
  double axial = 60e3;   // [N/m]
  double lateral = 8e3;  // [N/m]
  double twist = 20.0;   // [N m/rad]
};

struct SurfaceSpec {
  double stiffness = 1e6;  // [N/m]
  double damping = 500.0;  // [N s/m]
  double friction = 0.3;
};

struct PlaneSpec {
  Vec3 at = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  // unit, away from the solid
  SurfaceSpec surface;
};

struct BoxSpec {
  Pose X_SB;                        // centre and axes
  Vec3 half = Vec3::Constant(0.1);  // half the edges [m]
  SurfaceSpec surface;
};

struct CylinderSpec {
  Vec3 at = Vec3::Zero();     // centre
  Vec3 axis = Vec3::UnitZ();  // unit
  double radius = 0.1;        // [m]
  double half_length = 0.1;   // [m]
  bool hole = false;          // the inside of a tube, open at both ends
  SurfaceSpec surface;
};

// Frame K of the socket: origin at the centre of the rim, Z out of it, X across a corner.
struct HexSocketSpec {
  Pose X_SK;
  double across_flats = 6.05 * kMm;
  double key = 6.0 * kMm;        // across the key's flats
  double depth = 5.0 * kMm;      // of the bottom below the rim
  double chamfer = 0.8 * kMm;    // depth of the 45 degree lead-in
  double guide = 0.5 * kMm;      // depth below it in which the walls close in, 1:5
  double backlash = 4.0 * kDeg;  // of the key, from end to end
  double jam = 12.0 * kDeg;      // tilt from which the key jams
  SurfaceSpec surface;
};

struct ScrewThreadSpec {
  double start = 0.15;         // torque to turn [N m]
  double seat = 360.0 * kDeg;  // angle from which it grows [rad]
  double growth = 0.9;         // [N m/rad]
  double back_share = 0.8;     // of the torque, to loosen
};

struct SensorNoiseSpec {
  double force = 0.05;     // RMS per axis [N]
  double torque = 0.0025;  // [N m]
};

struct SensorDriftSpec {
  double rate = 0.02;  // RMS change of an axis' zero in a second [N]
  double range = 1.5;  // RMS of the zero in the long run [N]
  Wrench start;        // zeros to begin with, tip axes; those of the torque stay
};

struct SensorQuantisationSpec {
  double force = 0.03;    // smallest step [N]
  double torque = 0.001;  // [N m]
};

struct SensorSaturationSpec {
  double force = 1000.0;  // per axis [N]
  double torque = 100.0;  // [N m]
};

// In the order of RigEffectSpec.
enum class RigEffectKind : std::uint8_t {
  kServoLag,
  kEncoderOffsets,
  kBacklash,
  kGravity,
  kArmCompliance,
  kToolCompliance,
  kPlane,
  kBox,
  kCylinder,
  kHexSocket,
  kScrewThread,
  kSensorNoise,
  kSensorDrift,
  kSensorQuantisation,
  kSensorSaturation,
  kCount,
};

using RigEffectSpec = std::variant<ServoLagSpec, EncoderOffsetsSpec, BacklashSpec, GravitySpec,
                                   ArmComplianceSpec, ToolComplianceSpec, PlaneSpec, BoxSpec,
                                   CylinderSpec, HexSocketSpec, ScrewThreadSpec, SensorNoiseSpec,
                                   SensorDriftSpec, SensorQuantisationSpec, SensorSaturationSpec>;
static_assert(std::variant_size_v<RigEffectSpec> ==
              static_cast<std::size_t>(RigEffectKind::kCount));

inline RigEffectKind kind_of(const RigEffectSpec& spec) noexcept {
  return static_cast<RigEffectKind>(spec.index());
}

// What a scene file calls it, such as "hex_socket". Static storage.
const char* name_of(RigEffectKind kind) noexcept;

// True for what the tip can touch.
bool is_touched(RigEffectKind kind) noexcept;

// Most planes, boxes, cylinders and sockets together.
inline constexpr int kMostTouched = 8;

// The list of a scene: all that is simulated of arm, sensor and workpiece.
struct Simulate {
  std::vector<RigEffectSpec> effects;

  // The first effect of type T, or null where none is listed.
  template <typename T>
  const T* find() const noexcept {
    for (const RigEffectSpec& effect : effects) {
      if (const T* found = std::get_if<T>(&effect)) return found;
    }
    return nullptr;
  }
};

}  // namespace handrail
