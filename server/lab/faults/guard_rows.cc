#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/lab/faults/fault_rows.h"
#include "server/model/rv2a_limits.h"
#include "server/motion/guard.h"

namespace handrail::rows {
namespace {

constexpr Nanos kGuardCycle = 7'100 * kMicrosecond;
constexpr int kSequences = 50'000;
constexpr int kCommands = 20;

double both_ways(Random& random) { return 2.0 * random.uniform() - 1.0; }

// Commands as no planner makes them, each beside the last ones: steps and changes of them at and
// over the limits, held until the next one binds, jumps, and what is no number.
class HostileCommands {
 public:
  HostileCommands(const GuardLimits& limits, Random& random) : limits_(limits), random_(random) {}

  void begin_sequence() {
    kind_ = random_.uniform();
    size_ = 1.2 * random_.uniform();
    for (int i = 0; i < kJoints; ++i) side_[i] = both_ways(random_) < 0.0 ? -1.0 : 1.0;
  }

  JointVector next(const GuardState& s) {
    JointVector q = s.q + s.step;
    const int joint = static_cast<int>(6.0 * random_.uniform());
    for (int i = 0; i < kJoints; ++i) {
      const AxisLimits& l = limits_.axis[static_cast<std::size_t>(i)];
      if (kind_ < 0.6) {
        // Pushes on: as hard as the jerk, the acceleration or the speed allows, or a little harder.
        const double hard = kind_ < 0.5 ? 0.999 : 1.1;
        const double most = kind_ < 0.2 ? 2.0 * l.acceleration : l.acceleration;
        const double wanted = kind_ < 0.4 ? side_[i] * most : side_[i] * hard * l.speed - s.step[i];
        q[i] += std::clamp(wanted, std::max(s.change[i] - hard * l.jerk, -most),
                           std::min(s.change[i] + hard * l.jerk, most));
      } else if (kind_ < 0.7) {
        q[i] += both_ways(random_) * size_ * l.acceleration;
      } else if (kind_ < 0.8) {
        q[i] += s.change[i] + both_ways(random_) * size_ * l.jerk;
      } else if (kind_ < 0.85) {
        q[i] = s.q[i] + both_ways(random_) * size_ * l.speed;
      } else if (kind_ < 0.9) {
        q[i] = side_[i] < 0.0 ? limits_.lower[i] : limits_.upper[i];
      }
    }
    if (kind_ >= 0.9) q[joint] = kNumbers[static_cast<std::size_t>(8.0 * random_.uniform())];
    return q;
  }

 private:
  static constexpr std::array<double, 8> kNumbers = {std::numeric_limits<double>::quiet_NaN(),
                                                     std::numeric_limits<double>::infinity(),
                                                     -std::numeric_limits<double>::infinity(),
                                                     1e308,
                                                     -1e308,
                                                     1e9,
                                                     std::numeric_limits<double>::denorm_min(),
                                                     -0.0};
  const GuardLimits& limits_;
  Random& random_;
  double kind_ = 0.0;
  double size_ = 0.0;
  JointVector side_ = JointVector::Zero();
};

JointVector somewhere(const JointLimits& joints, Random& random) {
  JointVector q;
  for (int i = 0; i < kJoints; ++i) {
    q[i] = joints.lower[i] + (0.05 + 0.9 * random.uniform()) * (joints.upper - joints.lower)[i];
  }
  return q;
}

}  // namespace

// Joint commands straight into the guard, a million sequences of twenty in all runs. Now and then
// the arm stands elsewhere; in every second run in the middle of a workspace of 16 cm.
FaultOutcome x2a(const RowRun& row) {
  constexpr int kMoveAfter = 10;
  constexpr double kHalfBox = 0.08;  // [m]
  Random random(row.seed);
  AuditLimits judged;
  judged.joints = rv2a_limits();
  judged.max_jerk = judged.joints.max_jerk;
  BreachCounts breaches{};
  double worst = 0.0;
  std::uint64_t passed = 0;
  for (int part = 0; part < kSequences / kMoveAfter; ++part) {
    GuardState state;
    state.q = somewhere(judged.joints, random);
    if (row.index % 2 == 1) {
      const Vec3 tip = forward(judged.arm, state.q).p;
      judged.low = tip - Vec3::Constant(kHalfBox);
      judged.high = tip + Vec3::Constant(kHalfBox);
    }
    const GuardLimits limits(judged.joints, judged.arm, {judged.low, judged.high},
                             to_seconds(kGuardCycle));
    JointAudit audit(judged);
    audit.commanded(state.q, breaches);
    HostileCommands commands(limits, random);
    for (int i = 0; i < kMoveAfter * kCommands; ++i) {
      if (i % kCommands == 0) commands.begin_sequence();
      const JointVector wanted = commands.next(state);
      if (guard(limits, state, wanted).reason == Reason::kNone) ++passed;
      if (!audit.commanded(state.q, breaches)) break;
    }
    worst = std::max({worst, audit.speed(), audit.acceleration(), audit.jerk()});
  }
  FaultOutcome out;
  for (std::size_t i = 0; i < breaches.size(); ++i) {
    find(out, breaches[i], name_of(static_cast<Breach>(i)));
  }
  find(out, passed < kSequences, "hardly anything passed: nothing was tried");
  measure(out, worst, 1.0);
  return out;
}

}  // namespace handrail::rows
