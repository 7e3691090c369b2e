// One person turns the wrench.
#pragma once

#include <vector>

#include "server/lab/walls/joystick_people.h"
#include "server/lab/walls/wall_judge.h"
#include "server/lab/walls/wrench_path.h"

namespace handrail {

struct WrenchOptions : WallRunOptions {
  int turns = 4;   // that tighten
  int loosen = 0;  // afterwards
};

struct WrenchTurn {
  double peak = 0.0;   // of the force on the handle while in the semi-circle [N]
  double alpha = 0.0;  // turned in all, when the turn is over [rad]
};

struct WrenchResult : WallRunResult {
  std::vector<WrenchTurn> turns;  // in the order made
};

// Force growth from turn to turn while tightening, the least-squares slope of the peaks [N]; 0 with
// fewer than two turns.
double growth_of(const WrenchResult& result, int tightening);

// Distance of the forces felt in the tightening turns, 0 to the largest peak, from the real
// wrench's 0 to 16 N [N].
inline constexpr double kRealWrench = 16.0;  // over four turns (dissertation Fig. 2.7) [N]
double distance_from_real(const WrenchResult& result, int tightening);

// Led by the ball. `scene` has what `path` was made from.
WrenchResult turn_wrench(const Scene& scene, const WrenchPath& path, const JoystickPerson& person,
                         const WrenchOptions& options);

// The hand goes where a recording goes, laid on the middle of the loop. A turn is every visit of
// the semi-circle that turns by at least a quarter of it; of `options`, the numbers do not count.
WrenchResult turn_wrench(const Scene& scene, const WrenchPath& path, const JoystickPerson& person,
                         const RecordedMotion& recording, const WrenchOptions& options);

}  // namespace handrail
