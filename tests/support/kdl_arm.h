// The arm's chain in Orocos KDL, built from the Denavit-Hartenberg table alone: the independent
// oracle and the timing peer of server/kinematics.
#pragma once

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>

#include "server/base/joints.h"
#include "server/base/spatial.h"

namespace handrail::test {

// Rows of the table: theta offset [deg], d, a [mm], alpha [deg]; the last d ends at the hex key.
inline KDL::Chain kdl_arm(double d6_mm = 301.0) {
  struct Row {
    double theta_deg, d_mm, a_mm, alpha_deg;
  };
  const Row rows[] = {{0, 350, 100, -90}, {-90, 0, 250, 0}, {-90, 0, 130, -90},
                      {0, 250, 0, 90},    {0, 0, 0, -90},   {180, d6_mm, 0, 0}};
  KDL::Chain chain;
  for (const Row& row : rows) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ),
                                  KDL::Frame::DH(row.a_mm / 1000.0, row.alpha_deg * KDL::deg2rad,
                                                 row.d_mm / 1000.0, row.theta_deg * KDL::deg2rad)));
  }
  return chain;
}

// Forward kinematics by KDL, in this project's types.
class KdlForward {
 public:
  explicit KdlForward(double d6_mm = 301.0) : chain_(kdl_arm(d6_mm)), solver_(chain_) {}

  Pose operator()(const JointVector& q) {
    joints_.data = q;
    KDL::Frame tip;
    solver_.JntToCart(joints_, tip);
    Pose X_ST;
    X_ST.p = Vec3(tip.p.x(), tip.p.y(), tip.p.z());
    tip.M.GetQuaternion(X_ST.q.x(), X_ST.q.y(), X_ST.q.z(), X_ST.q.w());
    return X_ST;
  }

 private:
  KDL::Chain chain_;
  KDL::ChainFkSolverPos_recursive solver_;
  KDL::JntArray joints_{6};
};

}  // namespace handrail::test
