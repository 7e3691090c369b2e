#include "server/slave/follow_settings.h"
#include "server/kinematics/arm_of.h"

namespace handrail {

FollowSettings follow_settings(const Scene& scene, Nanos period, bool has_sensor,
                               double sensor_range, const Payload& payload, double force_lag) {
  FollowSettings out;
  MotionSettings motion;
  motion.arm = arm_of(scene);
  motion.limits = scene.limits.joints;
  motion.workspace = {scene.limits.workspace_low, scene.limits.workspace_high};
  motion.tip_speed = scene.limits.tip_speed;
  motion.dt = to_seconds(period);
  out.motion = motion;
  out.bumper = scene.bumper;
  out.sensor_range = sensor_range;
  out.payload = payload;
  out.force_lag = force_lag;
  out.bumper.sensor_lag += force_lag;
  out.sensor_required = has_sensor && scene.bumper.enabled;
  out.catch_up = scene.guidance.catch_up;
  out.catch_up_rotation = scene.guidance.catch_up_rotation;
  out.hashes = section_hashes(scene);
  out.scene = scene_name(scene.name);
  return out;
}

}  // namespace handrail
