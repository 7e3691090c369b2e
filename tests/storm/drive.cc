#include "tests/storm/drive.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "devices/rig/servo_arm.h"
#include "server/base/units.h"
#include "server/haptic/mapping.h"
#include "server/kinematics/rv2a.h"

namespace handrail::storm {
namespace {

// From the rig's start to the middle: back and down, away from the stretched elbow [m].
const Vec3 kToMiddle(-0.020, 0.0, -0.040);
const Vec3 kHandRange(0.070, 0.050, 0.030);  // of the device, 5 mm inside [m]

Engagement mapping() {
  MappingSettings settings;
  settings.scale = kScale;
  return {settings, Pose(), Pose()};
}

Vec3 rotation_vector(const Quat& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

std::string order(const Vec3& way_M, const Vec3& turn_M, double seconds) {
  return fmt::format(
      "hand {{ displacement_mm: [{}, {}, {}] rotation_deg: [{}, {}, {}] duration_s: {} }}",
      way_M.x() / kMm, way_M.y() / kMm, way_M.z() / kMm, turn_M.x() / kDeg, turn_M.y() / kDeg,
      turn_M.z() / kDeg, seconds);
}

}  // namespace

const char* const kSteadyDevice =
    "device { hand { reaction_ms: 0 tremor_rms_mm: 0 drift_rms_mm: 0 drift_rms_deg: 0 } }";

std::string scene_text() {
  return fmt::format(
      "name: 'storm' mapping {{ scale: {} }} smoother {{ form: LENGTH samples: 40 }}\n", kScale);
}

DriveRegion::DriveRegion() noexcept
    : middle_(forward(ArmGeometry(), ServoArmOptions::default_start())) {
  middle_.p += kToMiddle;
}

Pose DriveRegion::at(const Vec3& place, const Vec3& turn) const noexcept {
  Pose out = middle_;
  out.p += place.cwiseProduct(half());
  const double size = turn.norm();
  if (size > 0.0) {
    out.q = Quat(Eigen::AngleAxisd(kTurn * std::min(size, 1.0), turn / size)) * middle_.q;
  }
  return out;
}

Pose DriveRegion::any(Random& random) const noexcept {
  std::array<double, 6> share;
  for (double& s : share) s = 2.0 * random.uniform() - 1.0;
  return at(Vec3(share[0], share[1], share[2]), Vec3(share[3], share[4], share[5]));
}

Pose pose_of(const pb::PoseMm& in) {
  Pose out;
  if (in.position_mm_size() == 3) {
    out.p = kMm * Vec3(in.position_mm(0), in.position_mm(1), in.position_mm(2));
  }
  if (in.quaternion_size() == 4) {
    out.q = Quat(in.quaternion(0), in.quaternion(1), in.quaternion(2), in.quaternion(3));
  }
  return out;
}

std::string order_to(const Pose& goal, const pb::Status& status, double seconds) {
  const Pose U = pose_of(status.command());
  const Vec3 hand = pose_of(status.hand()).p;
  const Vec3 wanted = hand + mapping().to_hand(goal.p - U.p);
  const Vec3 way = wanted.cwiseMax(-kHandRange).cwiseMin(kHandRange) - hand;
  const Vec3 turn = mapping().turn_to_hand(rotation_vector(goal.q * U.q.conjugate()));
  return order(way, turn, seconds);
}

std::string order_home(const pb::Status& status, double seconds) {
  return order(-pose_of(status.hand()).p, Vec3::Zero(), seconds);
}

}  // namespace handrail::storm
