#include "server/model/simulate.h"

namespace handrail {

const char* name_of(RigEffectKind kind) noexcept {
  switch (kind) {
    case RigEffectKind::kServoLag: return "servo_lag";
    case RigEffectKind::kEncoderOffsets: return "encoder_offsets";
    case RigEffectKind::kBacklash: return "joint_backlash";
    case RigEffectKind::kGravity: return "gravity_sag";
    case RigEffectKind::kArmCompliance: return "arm_compliance";
    case RigEffectKind::kToolCompliance: return "tool_compliance";
    case RigEffectKind::kPlane: return "plane";
    case RigEffectKind::kBox: return "box";
    case RigEffectKind::kCylinder: return "cylinder";
    case RigEffectKind::kHexSocket: return "hex_socket";
    case RigEffectKind::kScrewThread: return "screw_thread";
    case RigEffectKind::kSensorNoise: return "sensor_noise";
    case RigEffectKind::kSensorDrift: return "sensor_drift";
    case RigEffectKind::kSensorQuantisation: return "sensor_quantisation";
    case RigEffectKind::kSensorSaturation: return "sensor_saturation";
    case RigEffectKind::kCount: break;
  }
  return "none";
}

bool is_touched(RigEffectKind kind) noexcept {
  return kind >= RigEffectKind::kPlane && kind <= RigEffectKind::kHexSocket;
}

}  // namespace handrail
