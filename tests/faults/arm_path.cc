#include "tests/faults/arm_path.h"

#include <algorithm>
#include <cmath>

#include "server/kinematics/rv2a.h"

namespace handrail::faults {
namespace {

constexpr double kNoWay = 1e-4;  // shorter has no direction [m]

}  // namespace

std::vector<TipAt> tips_of(const TapFile& tap, Nanos from, Nanos to) {
  std::vector<TipAt> out;
  for (const TapRecord& r : tap.records) {
    if (r.at < from || r.at > to) continue;
    out.push_back({r.at, forward(ArmGeometry(), Eigen::Map<const JointVector>(r.target.data())).p});
  }
  return out;
}

double backward(const std::vector<TipAt>& way) {
  if (way.empty()) return 0.0;
  const Vec3 whole = way.back().p - way.front().p;
  if (whole.norm() < kNoWay) return 0.0;
  const Vec3 direction = whole.normalized();
  double furthest = 0.0, out = 0.0;
  for (const TipAt& tip : way) {
    const double along = (tip.p - way.front().p).dot(direction);
    furthest = std::max(furthest, along);
    out = std::max(out, furthest - along);
  }
  return out;
}

double tracking_error(const std::vector<TipAt>& way, const Asked& asked) {
  double sum = 0.0;
  int count = 0;
  for (const TipAt& one : asked) {
    const auto next = std::lower_bound(way.begin(), way.end(), one.at,
                                       [](const TipAt& tip, Nanos at) { return tip.at < at; });
    if (next == way.begin() || next == way.end()) continue;
    const TipAt& before = *(next - 1);
    const double share = to_seconds(one.at - before.at) / to_seconds(next->at - before.at);
    sum += (before.p + share * (next->p - before.p) - one.p).squaredNorm();
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(sum / count);
}

}  // namespace handrail::faults
