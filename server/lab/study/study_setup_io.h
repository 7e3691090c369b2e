// A study's machine and people, from a scene, a population and single settings.
#pragma once

#include <string>
#include <vector>

#include "server/lab/study/population.h"
#include "server/lab/study/study_bench.h"

namespace handrail {

struct StudySetup {
  StudyMachine machine;
  Population population;
};

// Loads the scene and the population of these names and applies settings of the form KEY=VALUE:
//   a field of the scene        guidance.delta_mm=1, smoother.form=LOW_LAG
//   rig.FIELD                   of the rig's configuration, rig.servo_spread=0.1
//   operator.PARAMETER          median of a parameter of the population, operator.speed_mm_s=60
//   haptic.rate_hz              100 to 5000; the smoother keeps its length in time
//   haptic.torque               true: a device that turns the stylus too, as N- and F-rotation want
//   link.delay_ms               one way, 0 to 200
// The error names the setting or the file's place.
Result<StudySetup> study_setup(const std::string& scene, const std::string& population,
                               const std::vector<std::string>& settings);

}  // namespace handrail
