// One person shifts through the gears.
#pragma once

#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/lab/walls/joystick_people.h"
#include "server/lab/walls/wall_judge.h"

namespace handrail {

// The gears of a scene. Frame of the walls.
class GearGate {
 public:
  // From the scene's detent and return spring. The error says what is missing.
  static Result<GearGate> of(const Scene& scene);

  const std::vector<Vec2>& places() const noexcept { return places_; }       // [m]
  const std::vector<std::string>& names() const noexcept { return names_; }  // one for each
  const Vec2& neutral() const noexcept { return neutral_; }                  // [m]
  double home() const noexcept { return home_; }  // closer to neutral counts as there [m]
  // Where vertical aisles meet the horizontal one, and half the least way between them or, of one
  // alone, to its nearest gear.
  std::vector<Vec2> junctions() const;
  double junction_reach() const;  // [m]
  // The way from a to b: along the vertical aisle of a, the horizontal one, the vertical one of b.
  std::vector<Vec2> way(const Vec2& a, const Vec2& b) const;

 private:
  std::vector<Vec2> places_;
  std::vector<std::string> names_;
  Vec2 neutral_ = Vec2::Zero();
  double home_ = 0.0;
};

struct GearEvent {
  enum class Kind { kLock, kUnlock, kReturn };
  Kind kind = Kind::kLock;
  double t = 0.0;    // [s]
  std::string gear;  // N: of a return
};
const char* name_of(GearEvent::Kind kind) noexcept;

struct GearshiftResult : WallRunResult {
  std::vector<std::string> visited;  // GearJudge
  std::vector<GearEvent> events;
};

// From neutral through the gears in the scene's order; out of the last one the hand lets the spring
// take the lever home.
GearshiftResult shift_gears(const Scene& scene, const GearGate& gate, const JoystickPerson& person,
                            const WallRunOptions& options);

// The hand goes where a recording goes, laid on the neutral place.
GearshiftResult shift_gears(const Scene& scene, const GearGate& gate, const JoystickPerson& person,
                            const RecordedMotion& recording, const WallRunOptions& options);

}  // namespace handrail
