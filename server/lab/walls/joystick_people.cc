#include "server/lab/walls/joystick_people.h"

#include <algorithm>
#include <cmath>

#include "devices/joystick/joystick_data.h"
#include "server/base/random.h"

namespace handrail {
namespace {

// Lognormal about 1, kept within what was seen of people.
double about_one(Random& random, double spread) {
  return std::clamp(std::exp(spread * random.normal()), 0.5, 2.0);
}

}  // namespace

JoystickPerson joystick_person(std::uint64_t seed, int index) {
  const std::uint64_t own = seed * 1000003 + static_cast<std::uint64_t>(index);
  JoystickPerson person;
  if (index == 0) {
    person.hand = joystick_grip(0.5, own);
    return person;
  }
  Random random(own);
  person.hand = joystick_grip(0.2 + 0.6 * random.uniform(), random.bits());
  const double damping =
      person.hand.damping_ratio * std::sqrt(person.hand.stiffness * person.hand.mass);
  person.hand.mass = std::clamp(about_one(random, 0.3), 0.5, 1.5);
  person.hand.damping_ratio = damping / std::sqrt(person.hand.stiffness * person.hand.mass);
  person.hand.drift_rms *= about_one(random, 0.3);
  person.hand.tremor_rms *= about_one(random, 0.3);
  person.pace = about_one(random, 0.15);
  return person;
}

}  // namespace handrail
