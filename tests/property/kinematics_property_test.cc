#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "tests/property/draws.h"
#include "tests/support/arm_samples.h"

namespace handrail {
namespace {

using test::between;

using test::turn_free_distance;

// Joints within their ranges; every fourth or so has J5 or J4 at a round or singular value.
JointVector special_joints() {
  const JointLimits& limits = rv2a_limits();
  JointVector q;
  for (int i = 0; i < kJoints; ++i) q[i] = between(limits.lower[i], limits.upper[i]);
  const double special =
      *rc::gen::element(0.0, 1e-12, -1e-12, 1e-9, -1e-8, 1e-6, 0.5 * std::numbers::pi);
  switch (*rc::gen::inRange(0, 12)) {
    case 0: q[4] = special; break;
    case 1: q[3] = special; break;
    case 2: q[3] = q[4] = q[5] = special; break;
    default: break;
  }
  return q;
}

Vec3 even_unit() {
  const double height = between(-1.0, 1.0), angle = between(0.0, 2.0 * std::numbers::pi);
  const double radius = std::sqrt(1.0 - height * height);
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

bool well_away(const SingularityMargin& m) {
  return m.wrist > 0.15 && m.shoulder > 0.05 && m.elbow > 0.1;
}

RC_GTEST_PROP(KinematicsProperty, EverySolutionMapsBackToThePose, ()) {
  const JointVector q = special_joints(), seed = special_joints();
  const Pose X = forward({}, q);
  InverseSolutions found;
  inverse_all({}, X, seed, found);
  RC_ASSERT(found.count >= 1);
  RC_ASSERT(found.count <= 8);
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    RC_ASSERT(test::position_error(forward({}, found.q[i]), X) < 1e-9);
    RC_ASSERT(test::rotation_error(forward({}, found.q[i]), X) < 1e-8);
  }
}

RC_GTEST_PROP(KinematicsProperty, TheSeedIsInItsOwnSet, ()) {
  const JointVector seed = special_joints();
  const SingularityMargin m = singularity_margin({}, seed);
  InverseSolutions found;
  inverse_all({}, forward({}, seed), seed, found);
  double nearest = 10.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    nearest = std::min(nearest, turn_free_distance(found.q[i], seed));
  }
  // Within the singular radius the free joint comes from the seed; outside, digits are lost in
  // proportion to the distance.
  const double wrist = m.wrist > 0.9e-9 ? m.wrist : 1.0;
  RC_ASSERT(nearest < 1e-8 + 1e-14 / (std::min(m.shoulder, m.elbow) * wrist));
}

RC_GTEST_PROP(KinematicsProperty, NearAgreesWithTheSetOnTheSeedsBranch, ()) {
  const JointVector q = special_joints(), seed = special_joints();
  RC_PRE(well_away(singularity_margin({}, seed)));
  RC_PRE(singularity_margin({}, q).wrist > 1e-9);
  const Pose X = forward({}, q);
  InverseSolutions found;
  inverse_all({}, X, seed, found);
  JointVector near;
  const InverseStatus status = inverse_near({}, X, seed, near);
  bool listed = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
    if (!(found.branch[i] == branch_of({}, seed))) continue;
    listed = true;
    RC_ASSERT(status == InverseStatus::kOk);
    RC_ASSERT(turn_free_distance(near, found.q[i]) < 1e-12);
  }
  RC_ASSERT(listed == (status == InverseStatus::kOk));
}

RC_GTEST_PROP(KinematicsProperty, SmallTwistsMoveTheJointsLittleAwayFromSingularPoses, ()) {
  const JointVector seed = special_joints();
  const SingularityMargin m = singularity_margin({}, seed);
  RC_PRE(well_away(m));
  const double size = *rc::gen::element(1e-4, 1e-6, 1e-9);
  Pose X = forward({}, seed);
  X.p += size * even_unit();
  X.q = rotation_exp(size * even_unit()) * X.q;
  JointVector q;
  RC_ASSERT(inverse_near({}, X, seed, q) == InverseStatus::kOk);
  // The wrist centre moves at most 1.3 sizes; elbow lever arms are at least 0.07 m times the sine.
  const double arm_rate = 1.3 / m.shoulder + 2.0 * 1.3 / (0.07 * m.elbow);
  const double bound = 1.5 * size * (1.0 + arm_rate) * (1.0 + 1.0 / m.wrist);
  RC_ASSERT((q - seed).cwiseAbs().maxCoeff() < bound + 1e-13 / m.wrist);
  RC_ASSERT(test::position_error(forward({}, q), X) < 1e-12);
}

RC_GTEST_PROP(KinematicsProperty, AnExactlyStraightWristStaysWhereItIs, ()) {
  JointVector seed = special_joints();
  seed[4] = 0.0;
  const SingularityMargin m = singularity_margin({}, seed);
  RC_PRE(m.shoulder > 1e-3);
  JointVector q;
  RC_ASSERT(inverse_near({}, forward({}, seed), seed, q) == InverseStatus::kOk);
  RC_ASSERT(q[3] == seed[3]);
  RC_ASSERT((q - seed).cwiseAbs().maxCoeff() < 1e-11);
}

RC_GTEST_PROP(KinematicsProperty, AStraightWristBendsEitherWayWithoutTurningJ4, ()) {
  JointVector seed = special_joints();
  seed[4] = 0.0;
  RC_PRE(singularity_margin({}, seed).shoulder > 1e-3);
  JointVector next = seed;
  next[4] = between(-0.5, 0.5);
  RC_PRE(std::abs(next[4]) > 1e-6);
  JointVector q;
  RC_ASSERT(inverse_near({}, forward({}, next), seed, q) == InverseStatus::kOk);
  RC_ASSERT((q - next).cwiseAbs().maxCoeff() < 1e-8);
}

RC_GTEST_PROP(KinematicsProperty, AJointPathIsFollowedAlsoThroughTheWristSingularity, ()) {
  constexpr int kSteps = 100;
  const JointVector from = special_joints(), to = special_joints();
  // While J5 lingers within 1e-9 of zero, J4 stays behind the path and must catch up afterwards.
  RC_PRE(std::abs(to[4] - from[4]) > 1e-4);
  JointVector q = from;
  JointVector previous = from;
  const double longest = (to - from).cwiseAbs().maxCoeff() / kSteps;
  for (int i = 1; i <= kSteps; ++i) {
    const JointVector wanted = from + (to - from) * (static_cast<double>(i) / kSteps);
    // Beside the J1 axis the joints rightly move fast: only straight paths through it are smooth.
    RC_PRE(singularity_margin({}, wanted).shoulder > 0.03);
    RC_ASSERT(inverse_near({}, forward({}, wanted), previous, q) == InverseStatus::kOk);
    RC_ASSERT((q - previous).cwiseAbs().maxCoeff() < 2.0 * longest + 1e-6);
    previous = q;
  }
  RC_PRE(std::abs(std::sin(to[4])) > 1e-5);
  RC_ASSERT((q - to).cwiseAbs().maxCoeff() < 1e-6);
}

}  // namespace
}  // namespace handrail
