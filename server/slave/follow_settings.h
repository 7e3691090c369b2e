// What a scene means for the slave's step.
#pragma once

#include "server/base/time.h"
#include "server/control/follow_step.h"
#include "server/scene/scene.h"

namespace handrail {

// `period`: the controller's cycle. `has_sensor`: a force sensor is configured; the arm then holds
// when its readings fail. `sensor_range`: a larger component is a fault [N]. `payload`: what hangs on
// the sensor.
FollowSettings follow_settings(const Scene& scene, Nanos period, bool has_sensor,
                               double sensor_range, const Payload& payload = {});

}  // namespace handrail
