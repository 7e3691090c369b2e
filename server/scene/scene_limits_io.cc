#include "server/scene/scene_limits_io.h"

#include <cmath>
#include <string>

#include "server/base/rv2a_limits.h"
#include "server/base/units.h"

namespace handrail {
namespace {

// A joint that takes longer than 80 ms to its full acceleration could hardly be stopped [1/s].
constexpr double kLeastJerk = 12.5;

using Numbers = google::protobuf::RepeatedField<double>;

JointVector joints_of(const Numbers& degrees) {
  JointVector v;
  for (int i = 0; i < kJoints; ++i) v[i] = degrees[i] * kDeg;
  return v;
}

std::string joint_field(const char* name, int i) {
  return std::string("limits.") + name + "[" + std::to_string(i) + "]";
}

}  // namespace

std::optional<FieldProblem> limits_from(const pb::Limits& in, Scene::Limits& out) {
  const JointLimits& table = rv2a_limits();
  out.joints = table;
  out.joints.max_speed *= in.speed_share();
  out.tip_speed = in.tip_speed_mm_s() * kMm;
  if (in.joint_acceleration_deg_s2_size() > 0) {
    out.joints.max_acceleration = joints_of(in.joint_acceleration_deg_s2());
  }
  out.joints.max_jerk = in.joint_jerk_deg_s3_size() > 0 ? joints_of(in.joint_jerk_deg_s3())
                                                        : out.joints.max_acceleration / kJerkTime;
  if (in.joint_lower_deg_size() > 0) out.joints.lower = joints_of(in.joint_lower_deg());
  if (in.joint_upper_deg_size() > 0) out.joints.upper = joints_of(in.joint_upper_deg());
  const auto degrees = [](double rad) { return number_text(std::round(rad / kDeg * 1e9) / 1e9); };
  for (int i = 0; i < kJoints; ++i) {
    const double slowest = kLeastJerk * out.joints.max_acceleration[i];
    if (out.joints.max_jerk[i] < slowest) {
      return FieldProblem{joint_field("joint_jerk_deg_s3", i),
                          degrees(out.joints.max_jerk[i]) + " deg/s^3 is below " +
                              degrees(slowest) + ", with which full acceleration takes 80 ms"};
    }
    const double lower = out.joints.lower[i], upper = out.joints.upper[i];
    const std::string joint = {'J', static_cast<char>('1' + i)};
    if (lower < table.lower[i]) {
      return FieldProblem{joint_field("joint_lower_deg", i),
                          degrees(lower) + " is below Table 3.1's " + degrees(table.lower[i]) +
                              " deg for " + joint};
    }
    if (upper > table.upper[i]) {
      return FieldProblem{joint_field("joint_upper_deg", i),
                          degrees(upper) + " is above Table 3.1's " + degrees(table.upper[i]) +
                              " deg for " + joint};
    }
    if (lower >= upper) {
      const char* field = in.joint_upper_deg_size() > 0 ? "joint_upper_deg" : "joint_lower_deg";
      return FieldProblem{joint_field(field, i), joint + " would range from " + degrees(lower) +
                                                     " to " + degrees(upper) +
                                                     " deg, expected lower below upper"};
    }
  }
  return std::nullopt;
}

}  // namespace handrail
