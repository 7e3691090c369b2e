#include "server/scene/scene_limits_io.h"

#include <cmath>
#include <string>

#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/model/rv2a_limits.h"
#include "server/scene/numbers.h"

namespace handrail {
namespace {

// A joint that takes longer than 80 ms to its full acceleration could hardly be stopped [1/s].
constexpr double kLeastJerk = 12.5;

JointVector joints_of(const Numbers& degrees) {
  JointVector v;
  for (int i = 0; i < kJoints; ++i) v[i] = degrees[i] * kDeg;
  return v;
}

std::string joint_field(const char* name, int i) {
  return std::string("limits.") + name + "[" + std::to_string(i) + "]";
}

// A box less wide than this leaves the tip no way to stop in [mm].
constexpr double kLeastBox = 50.0;

std::optional<FieldProblem> workspace_from(const pb::Limits& in, Scene::Limits& out) {
  for (int k = 0; k < 3; ++k) {
    if (in.workspace_low_mm_size() > 0) out.workspace_low[k] = in.workspace_low_mm(k) * kMm;
    if (in.workspace_high_mm_size() > 0) out.workspace_high[k] = in.workspace_high_mm(k) * kMm;
    const double low = out.workspace_low[k] / kMm, high = out.workspace_high[k] / kMm;
    if (high - low < kLeastBox) {
      const char* field =
          in.workspace_high_mm_size() > 0 ? "workspace_high_mm" : "workspace_low_mm";
      return FieldProblem{std::string("limits.") + field + "[" + std::to_string(k) + "]",
                          "the workspace would reach from " + number_text(low) + " to " +
                              number_text(high) + " mm along " + std::string(1, "xyz"[k]) +
                              ", expected at least 50 mm"};
    }
  }
  return std::nullopt;
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
  return workspace_from(in, out);
}

}  // namespace handrail
