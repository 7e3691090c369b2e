// What a sensor with a payload reads in several orientations, computed apart from the fit.
#pragma once

#include <vector>

#include "server/task/payload_fit.h"

namespace handrail::test {

inline Payload half_a_kilogram() {
  return {0.5, {0.004, -0.002, 0.06}, {{1.5, -2.0, 0.7}, {0.05, -0.02, 0.01}}};
}

// The tip points down, then leans by `lean` [rad] to `count` sides.
inline std::vector<Quat> leaning(int count, double lean) {
  const Quat down = rotation_exp(Vec3(M_PI, 0, 0));
  std::vector<Quat> out = {down};
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * M_PI * i / count;
    out.push_back(rotation_exp(lean * Vec3(std::cos(a), std::sin(a), 0)) * down);
  }
  return out;
}

// Gravity as a matrix in the base frame, moments by the definition.
inline std::vector<PayloadSample> samples_of(const Payload& p, const std::vector<Quat>& turns) {
  std::vector<PayloadSample> out;
  for (const Quat& q : turns) {
    const Vec3 weight_S(0, 0, -9.80665 * p.mass);
    const Mat3 R = q.toRotationMatrix();
    const Vec3 moment_S = (R * p.centre_T).cross(weight_S);
    out.push_back(
        {q,
         {R.transpose() * weight_S + p.bias_T.force, R.transpose() * moment_S + p.bias_T.torque}});
  }
  return out;
}

}  // namespace handrail::test
