// The simulated people who hold the joystick.
#pragma once

#include <cstdint>

#include "devices/hand/hand_model.h"

namespace handrail {

struct JoystickPerson {
  HandOptions hand;
  double pace = 1.0;  // of moves the person times, times the usual speed
};

// Person `index` of a seed, the same however many there are. The first is the typical one, the
// others vary in mass, grip, drift, tremor and pace: our ranges, about those of joystick_data.h; no
// measured population of this device is known.
JoystickPerson joystick_person(std::uint64_t seed, int index);

}  // namespace handrail
