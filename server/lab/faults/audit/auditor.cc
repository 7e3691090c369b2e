#include "server/lab/faults/audit/auditor.h"

#include <algorithm>

namespace handrail {
namespace {

constexpr double kRounding = 1e-9;  // of a limit

}  // namespace

Auditor::Auditor(const AuditLimits& limits)
    : most_force_(limits.force * (1.0 + kRounding)),
      joints_(limits),
      motion_(to_seconds(limits.period)),
      stops_(limits.period),
      places_(limits),
      tool_(limits.catch_up * to_seconds(limits.period), limits.period) {}

void Auditor::sent(std::uint64_t number, std::uint32_t incarnation, const MasterState& state,
                   bool repeated) noexcept {
  master_.sent(number, incarnation, state, repeated);
}

void Auditor::delivered(const Delivery& delivery) noexcept {
  if (!master_.delivered(delivery, report_)) return;
  const SentState& newest = master_.newest();
  if (newest.has_command) places_.remember(newest.X_SU.p, delivery.at);
  tool_.take(newest);
}

void Auditor::felt(const Wrench& f) noexcept {
  if (!is_finite(f) || f.force.norm() > most_force_) report_.add(Breach::kForce);
}

void Auditor::reported(std::uint64_t applied) noexcept {
  if (applied == applied_) return;
  const std::uint32_t incarnation = master_.newest().incarnation;
  if (applied < applied_ && applied != 0 && incarnation == applied_of_) {
    report_.add(Breach::kBackward);
  }
  applied_ = applied;
  applied_of_ = incarnation;
}

void Auditor::touched(const Vec3& n_S) noexcept {
  touched_ = true;
  n_S_ = n_S;
}

void Auditor::commanded(const JointVector& q, Nanos at) noexcept {
  ++report_.cycles;
  const bool was_at_rest = joints_.at_rest();
  // The stop is judged by how fast the arm was before this command.
  motion_.set_stop_time(joints_.time_to_stop());
  master_.judge(at, report_);
  stops_.judge(master_, at, was_at_rest, motion_.stop_time(), report_);
  tool_.expect(master_, joints_, motion_, at);
  if (!joints_.commanded(q, report_.breaches)) return;
  take_joints();
  if (touched_) hold_out(at);
  if (tool_.off(tip())) report_.add(Breach::kOffTool);
  motion_.commanded(tip());
  if (!joints_.moving()) return places_.rests(tip());
  ++report_.moved;
  if (!led()) stops_.moved_unled(at, was_at_rest, report_);
  if (!master_.any()) return;
  if (!places_.commanded(master_.newest(), tool_, joints_, motion_, at)) {
    report_.add(Breach::kUnasked);
  }
}

void Auditor::take_joints() noexcept {
  report_.speed = joints_.speed();
  report_.acceleration = joints_.acceleration();
  report_.jerk = joints_.jerk();
  if (report_.cycles == 1) motion_.stand(tip());
}

// The place commanded, out of the surface as far as the tip is, is one where it may be.
void Auditor::hold_out(Nanos at) noexcept {
  touched_ = false;
  const SentState& newest = master_.newest();
  if (!master_.any() || !newest.has_command) return;
  const Vec3 p = newest.X_SU.p + std::max(0.0, (tip() - newest.X_SU.p).dot(n_S_)) * n_S_;
  places_.remember(p, at);
  tool_.hold_out(p);
}

}  // namespace handrail
