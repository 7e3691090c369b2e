// Where the arm cannot go on as it did: its singular poses and the ends of its joints' ranges.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <string>
#include <utility>

#include "server/base/units.h"
#include "server/kinematics/arm_of.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/stability/arm_cell.h"
#include "server/lab/stability/stability_case.h"
#include "server/model/rv2a_limits.h"
#include "server/model/scene.h"

namespace handrail {
namespace {

constexpr double kBesideEnd = 0.25;  // of a range, inside it and beyond [rad]

JointVector degrees(double j1, double j2, double j3, double j4, double j5, double j6) {
  return (JointVector() << j1, j2, j3, j4, j5, j6).finished() * kDeg;
}

// The way of the tip from one pose to another, straight.
ArmWay between(const JointVector& from, const JointVector& to) {
  const ArmGeometry arm = arm_of(Scene());
  const Pose a = forward(arm, from), b = forward(arm, to);
  return {from, b.p - a.p, rotation_log(b.q * a.q.conjugate())};
}

struct ArmPlace {
  std::string name;
  ArmWay way;
};

// The wrist stretched: J5 = 0. The elbow: at J3 = 27.5 degrees, 22.5 beyond the end of its range,
// so it is the arm's reach that ends. The shoulder: the wrist's centre over the axis of J1, 60 mm
// behind where the way begins.
std::vector<ArmPlace> singular() {
  const JointVector wrist = degrees(0, 10, 80, 0, 17, 0);
  const JointVector bent = degrees(5, 10, 80, 6, 17, 0);
  const JointVector elbow = degrees(0, 30, 75, 0, 60, 0);
  const JointVector shoulder = degrees(0, -40, 92.9, 0, 90, 0);
  const Vec3 back(-0.06, 0.0, 0.0), beside(0.0, 0.005, 0.0);
  return {{"wrist/to", between(wrist, degrees(0, 10, 80, 0, 0, 0))},
          {"wrist/through", between(wrist, degrees(0, 10, 80, 0, -17, 0))},
          {"wrist/beside", between(bent, degrees(-5, 10, 80, -6, -17, 0))},
          {"wrist/by-the-place", {wrist, Vec3(0.0, 0.0, 0.15), Vec3::Zero()}},
          {"elbow/to", {elbow, Vec3(0.10, 0.0, 0.0), Vec3::Zero()}},
          {"elbow/beyond", {elbow, Vec3(0.40, 0.0, 0.0), Vec3::Zero()}},
          {"elbow/beyond-and-up", {elbow, Vec3(0.25, 0.0, 0.25), Vec3::Zero()}},
          {"shoulder/to", {shoulder, back, Vec3::Zero()}},
          {"shoulder/through", {shoulder, 2.0 * back, Vec3::Zero()}},
          {"shoulder/beside", {shoulder, 2.0 * back + 2.0 * beside, Vec3::Zero()}}};
}

// From inside of each end of each joint's range to beyond it.
std::vector<ArmPlace> ends() {
  const JointLimits& limits = rv2a_limits();
  const JointVector middle = degrees(0, 20, 100, 0, 50, 0);
  std::vector<ArmPlace> out;
  for (int i = 0; i < kJoints; ++i) {
    for (const bool upper : {false, true}) {
      JointVector from = middle, to = middle;
      const double end = upper ? limits.upper[i] : limits.lower[i];
      const double inward = upper ? -kBesideEnd : kBesideEnd;
      from[i] = end + inward;
      to[i] = end - inward;
      out.push_back({fmt::format("J{}/{}", i + 1, upper ? "upper" : "lower"), between(from, to)});
    }
  }
  return out;
}

}  // namespace

std::vector<StabilityCase> arm_cases() {
  std::vector<StabilityCase> out;
  for (const auto& [kind, places] : {std::pair{"singular", singular()}, std::pair{"end", ends()}}) {
    for (const ArmPlace& place : places) {
      for (const auto& [name, speed] : {std::pair{"slow", 0.1}, std::pair{"fast", 1.0}}) {
        ArmWay way = place.way;
        way.tip_speed = speed;
        out.push_back({fmt::format("arm/{}/{}/{}", kind, place.name, name), true, true,
                       [way](std::uint64_t seed) { return run_arm_way(way, seed); },
                       CaseSize::kSmall});
      }
    }
  }
  return out;
}

}  // namespace handrail
