// What a scene means for the slave's step.
#pragma once

#include "server/base/time.h"
#include "server/follow/follow_step.h"
#include "server/model/scene.h"

namespace handrail {

// `period`: the controller's cycle. `has_sensor`: a force sensor is configured; the arm then holds
// when its readings fail. `sensor_range`: a larger component is a fault [N]. `payload`: what hangs
// on the sensor. `force_lag`: of the force's low pass [s], which makes what the bumper feels as
// much later.
FollowSettings follow_settings(const Scene& scene, Nanos period, bool has_sensor,
                               double sensor_range, const Payload& payload = {},
                               double force_lag = 0.0);

}  // namespace handrail
