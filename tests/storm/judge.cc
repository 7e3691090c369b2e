#include "tests/storm/judge.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <optional>

#include "server/base/units.h"
#include "server/lab/faults/audit/controller_audit.h"
#include "server/model/rv2a_limits.h"

namespace handrail::storm {
namespace {

constexpr double kStandingStep = 1e-6;  // float32 tells no smaller one [rad]
constexpr Nanos kOneCause = 200 * kMillisecond;
constexpr Nanos kStands = 200 * kMillisecond;  // longer than any gap that a motion outlives
constexpr Nanos kLatest = 200 * kMillisecond;  // that a rig on a busy machine is behind

JointVector vector(const std::array<double, kJoints>& q) {
  return Eigen::Map<const JointVector>(q.data());
}

// Violations of one kind, the first of each cause.
class Recorder {
 public:
  explicit Recorder(std::vector<Violation>& out) : out_(out) {}
  void add(Nanos at, const std::string& what) {
    if (last_ < 0 || at - last_ > kOneCause) out_.push_back({at, what});
    last_ = at;
  }

 private:
  std::vector<Violation>& out_;
  Nanos last_ = -1;
};

bool sent(const TapRecord& r) { return r.has(kTapAccepted) || r.lost > 0; }

// After a pause of more cycles than these a slave begins anew, from a standing arm (follow_gap.cc).
constexpr std::size_t kGoesOnAfter = 4;

// Why a cycle got nothing, of those between two that were sent something, on a computer that is
// busy elsewhere: the last of them.
enum class Missed {
  kNo,
  kLeftOut,  // so late that the slave did not send it: as good as lost
  kLate,     // that, or it came after its cycle
};

// A slave sends without a reply only when an eighth of the cycle is left, so what came earlier
// after a cycle that was sent nothing was on its way when that cycle ran. One that took its way for
// a long one sends when half is left: what then counts as late without being so is excused only if
// that alone makes sound what follows.
Missed missed(const TapFile& tap, std::size_t i) {
  if (i < 2) return Missed::kNo;
  const TapRecord& now = tap.records[i];
  std::size_t empty = 0;
  while (empty + 1 < i && empty <= kGoesOnAfter && !sent(tap.records[i - 1 - empty]) &&
         tap.records[i - 1 - empty].has(kTapSession)) {
    ++empty;
  }
  const TapRecord& before = tap.records[i - 1 - empty];
  const bool goes_on = now.has(kTapAccepted) && empty > 0 && empty <= kGoesOnAfter &&
                       sent(before) &&
                       now.at - before.at == static_cast<Nanos>(empty + 1) * tap.period;
  if (!goes_on) return Missed::kNo;
  const bool early = 8 * now.came * kMicrosecond < 7 * tap.period;
  return now.lost == 0 && early ? Missed::kLate : Missed::kLeftOut;
}

// The audit of one arm. A command that was missed may be read as one in time, or as lost, if that
// alone makes sound what follows.
class Judge {
 public:
  explicit Judge(Nanos period) : audit_(rv2a_limits(), period) {}

  void place(const JointVector& q) { audit_.place(q); }
  void until(Nanos now) {
    audit_.until(now);
    for (auto& other : others_) {
      if (other) other->until(now);
    }
  }
  TargetVerdict accepted(const TapRecord& r, const JointVector& q, int lost, Missed missed) {
    if (missed != Missed::kNo) {
      open_ = kOpen;
      others_[0] = others_[1] = audit_;
      others_[0]->came_late();
      if (missed != Missed::kLate) others_[0].reset();
    }
    TargetVerdict verdict = audit_.accepted(r.at, q, lost);
    const bool sound = verdict.fine();
    --open_;
    for (std::size_t i = 0; i < others_.size(); ++i) {
      std::optional<ControllerAudit>& other = others_[i];
      if (!other) continue;
      const bool left_out = i == 1 && missed != Missed::kNo;
      const TargetVerdict instead = other->accepted(r.at, q, lost + (left_out ? 1 : 0));
      if (instead.fine() && !verdict.fine()) {
        audit_ = *other;
        verdict = instead;
        ++late_;
      }
      if (!sound || !instead.fine() || open_ == 0) other.reset();
    }
    return verdict;
  }

  const ControllerAudit& audit() const { return audit_; }
  std::uint64_t late() const { return late_; }

 private:
  static constexpr int kOpen = 4;  // targets that one cycle has a part in the third differences of

  ControllerAudit audit_;
  std::array<std::optional<ControllerAudit>, 2> others_;  // it came late, it was left out
  int open_ = 0;
  std::uint64_t late_ = 0;
};

std::string breach_text(const TargetVerdict& v, Nanos gap, int lost, Nanos period) {
  return fmt::format(
      "J{} beyond its limits: {:.2f} of a step, {:.2f} of speed, {:.2f} of acceleration, {:.2f} of "
      "jerk, {} {} cycles after the last step, targets lost for {} cycles",
      v.joint + 1, v.step, v.speed, v.acceleration, v.jerk,
      v.from_rest ? "as a start from rest" : "as a motion that goes on",
      (gap + period / 2) / period, lost);
}

}  // namespace

void Figures::add(const Figures& other) {
  targets += other.targets;
  breaches += other.breaches;
  step = std::max(step, other.step);
  acceleration = std::max(acceleration, other.acceleration);
  jerk = std::max(jerk, other.jerk);
  held += other.held;
  late += other.late;
  halts += other.halts;
  hardest_halt = std::max(hardest_halt, other.hardest_halt);
}

std::size_t first_judged(const TapFile& tap) {
  if (tap.records.empty() || tap.records.front().number == 1) return 0;
  std::size_t stands_since = 0;
  for (std::size_t i = 1; i < tap.records.size(); ++i) {
    if (tap.records[i].target != tap.records[stands_since].target) stands_since = i;
    if (tap.records[i].at - tap.records[stands_since].at >= kStands) return i;
  }
  return tap.records.size();
}

Figures judge_tap(const TapFile& tap, const std::vector<Forbidden>& forbidden,
                  std::vector<Violation>& violations) {
  Judge judge(tap.period);
  Recorder limits(violations), motion(violations), alarms(violations);
  JointVector held = JointVector::Zero();
  Nanos last_target = 0;
  Nanos first_lost = 0;  // since the last step; 0: none
  const std::size_t first = first_judged(tap);
  for (std::size_t i = first; i < tap.records.size(); ++i) {
    const TapRecord& r = tap.records[i];
    const JointVector q = vector(r.target);
    if (i == first) {
      judge.place(q);
      held = q;
      last_target = r.at;
    }
    judge.until(r.at);
    if (r.lost > 0 && first_lost == 0) first_lost = r.at;
    if (r.has(kTapAccepted)) {
      const Nanos since = first_lost == 0 ? 0 : r.at - first_lost;
      const auto lost = static_cast<int>((since + tap.period / 2) / tap.period);
      const TargetVerdict verdict = judge.accepted(r, q, lost, missed(tap, i));
      if (!verdict.fine()) {
        limits.add(r.at, breach_text(verdict, r.at - last_target, lost, tap.period));
      }
      if (q != held) {
        last_target = r.at;
        first_lost = 0;
      }
    }
    const double moved = (q - held).cwiseAbs().maxCoeff();
    held = q;
    if (moved > kStandingStep) {
      for (const Forbidden& span : forbidden) {
        if (r.at <= span.from || r.at > span.to) continue;
        motion.add(r.at, fmt::format("moved {:.0f} ms after it had to stand: {}",
                                     1e3 * to_seconds(r.at - span.from), span.why));
      }
    }
    if (r.has(kTapAlarm) && r.alarm != static_cast<std::uint8_t>(AlarmKind::kTimeOut)) {
      alarms.add(r.at, fmt::format("alarm of the controller: J{} {}", r.joint,
                                   describe(static_cast<AlarmKind>(r.alarm))));
    }
  }
  const ControllerAudit& audit = judge.audit();
  Figures out;
  out.targets = audit.targets();
  out.breaches = audit.breaches();
  out.step = audit.worst().step;
  out.acceleration = audit.worst().acceleration;
  out.jerk = audit.worst().jerk;
  out.held = audit.held();
  out.late = judge.late();
  out.halts = audit.halts();
  out.hardest_halt = audit.hardest_halt();
  return out;
}

std::string trace(const TapFile& tap, Nanos at, int before, int after) {
  std::string out;
  for (const TapRecord& r : tap.records) {
    if (r.at < at - before * tap.period || r.at > at + after * tap.period) continue;
    out += fmt::format("  {:+9.1f} ms  {}{}{}{}{}{}  ", 1e3 * to_seconds(r.at - at),
                       r.has(kTapAccepted) ? 'A' : '-', r.has(kTapSession) ? 'S' : '-',
                       r.has(kTapOpened) ? 'O' : '-', r.has(kTapClosed) ? 'C' : '-',
                       r.has(kTapAlarm) ? '!' : '-', r.has(kTapCableOut) ? 'X' : '-');
    for (const double q : r.target) out += fmt::format(" {:9.4f}", q / kDeg);
    out += '\n';
  }
  return out;
}

bool measured_at(const TapFile& tap, Nanos at, JointVector& q) {
  bool found = false;
  for (const TapRecord& r : tap.records) {
    if (r.at > at) break;
    q = vector(r.measured);
    found = at - r.at < kLatest;
  }
  return found;
}

}  // namespace handrail::storm
