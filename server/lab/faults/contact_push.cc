#include "server/lab/faults/contact_push.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "server/model/scene.h"

namespace handrail {
namespace {

FaultOptions in_contact(FaultOptions options) {
  options.contact = true;
  return options;
}

}  // namespace

Push::Push(const RowRun& row, bool slide, FaultOptions options) : run(row, in_contact(options)) {
  speed = 0.02 + 0.08 * run.random().uniform();
  rate_ = slide ? 2.0 * std::numbers::pi * (0.2 + 0.5 * run.random().uniform()) : 0.0;
  const double angle = 2.0 * std::numbers::pi * run.random().uniform();
  along_ = {std::cos(angle), std::sin(angle), 0.0};
  run.layers().hand = [this](Nanos at, HandReading& hand) { lead(at, hand); };
  run.layers().force = [this](Nanos at, Wrench& f, bool& valid) {
    if (falsify) falsify(at, f, valid);
    measured_ = valid ? f.force.norm() : 0.0;
  };
}

bool Push::begin() {
  if (!run.engage()) return false;
  go_down();
  return true;
}

bool Push::roam(Nanos span) {
  if (!run.engage()) return false;
  roam_from_ = run.now();
  pass(span);
  return true;
}

void Push::freeze_sensor() {
  falsify = [last = std::optional<Wrench>()](Nanos, Wrench& f, bool&) mutable {
    if (!last) last = f;
    f = *last;
  };
}

void Push::go_down() {
  from_ = run.now();
  back_ = kForever;
  if (roam_from_ == kForever) roam_from_ = from_;
}

void Push::pass(Nanos span, bool driven) {
  for (const Nanos end = run.now() + span; run.now() < end;) {
    const double before = height();
    const double way = run.auditor().way_to_rest(), felt = measured_;
    driven ? run.drive(kMillisecond) : run.run(kMillisecond);
    watch(felt, before, way);
  }
}

Nanos Push::pass_until(double force) {
  for (const Nanos end = run.now() + 10 * kSecond; run.now() < end;) {
    pass(kMillisecond);
    if (run.true_force() > force) return run.now();
  }
  return kForever;
}

FaultOutcome Push::outcome(bool lies, double bound) {
  FaultOutcome out = run.outcome();
  const bool stopped = out.measured && out.worst > out.bound;
  if (!stopped) measure(out, peak, bound);
  find(out, peak > bound, "over the promised force");
  if (!lies) find(out, inward_, "further in above the threshold");
  return out;
}

double Push::swing() {
  double low = run.true_force(), high = low;
  for (int i = 0; i < 1000; ++i) {
    pass(kMillisecond);
    low = std::min(low, run.true_force());
    high = std::max(high, run.true_force());
  }
  return high - low;
}

void Push::lead(Nanos at, HandReading& hand) const {
  constexpr double kDepth = 0.01, kBack = 0.1;  // [m], [m/s]
  const Scene::Mapping mapping;
  if (roam_from_ == kForever) return;
  double down = 0.0;
  if (from_ != kForever) {
    down = std::min(kFaultGap + kDepth, speed * to_seconds(at - from_));
  }
  if (at > back_) down -= kBack * to_seconds(at - back_);
  const Vec3 p_S = std::max(0.0, down) * -fault_normal() +
                   0.01 * std::sin(rate_ * to_seconds(at - roam_from_)) * along_;
  hand.X_MH.p = mapping.R_SM.transpose() * p_S / mapping.scale;
}

// Above the threshold the place where the commands can come to rest only ever rises.
void Push::watch(double felt, double before, double way) {
  peak = std::max(peak, run.true_force());
  if (run.cell().targets().empty()) return;
  lowest_ = felt > kThreshold ? std::max(lowest_, before - way) : -1.0;
  if (height() < lowest_ - 1e-6) ++inward_;
}

}  // namespace handrail
