#include "server/haptic/cue.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kTurn = 2.0 * 3.14159265358979323846;
constexpr int kPeriods = 3;  // of a tremble

struct Pattern {
  double frequency = 40.0;  // [Hz]
  double size = 0.0;        // [N]
  double start = 0.0;       // of the first tremble [s]
  double every = 0.15;      // [s]
  int trembles = 0;
  double length = 0.0;  // with the pause after it [s]
};

// Those of the link begin when the fading force has left.
constexpr Pattern pattern_of(Cue cue) {
  switch (cue) {
    case Cue::kHold: return {40.0, kLargestCue, 0.05, 0.15, 2, 0.35};
    case Cue::kLost: return {40.0, kLargestCue, 0.05, 0.15, 3, 0.5};
    case Cue::kLimit: return {40.0, kLargestCue, 0.0, 0.15, 1, 0.5};
    case Cue::kSingularity: return {60.0, 0.12, 0.0, 0.08, 4, 0.7};
    case Cue::kNone: break;
  }
  return {};
}

// Time within the tremble that runs at `t`, negative between them [s].
double within_tremble(const Pattern& p, double t) {
  const double since = t - p.start;
  if (!(since >= 0.0 && since < p.trembles * p.every)) return -1.0;
  const double within = std::fmod(since, p.every);
  return within < kPeriods / p.frequency ? within : -1.0;
}

}  // namespace

double cue_force(Cue cue, double t) noexcept {
  const Pattern p = pattern_of(cue);
  const double within = within_tremble(p, t);
  return within < 0.0 ? 0.0 : p.size * std::sin(kTurn * p.frequency * within);
}

Cue KeptBack::step(const MotionLedger& ledger, const Vec3& p_ST, double dt) noexcept {
  constexpr double kBegins = 2e-3, kEnds = 1e-3;  // [m]
  constexpr double kPatience = 0.1;               // [s]
  // Limits of acceleration and jerk make the arm follow so much later, at most [s].
  constexpr double kLag = 0.1;
  constexpr double kSmoothed = 0.05;  // the slave's cycle is longer than ours [s]
  constexpr auto kReach = static_cast<Eigen::Index>(MotionStage::kReach);
  constexpr auto kSingular = static_cast<Eigen::Index>(MotionStage::kSingularity);
  static_assert(kSingular - kReach == 2, "reach, limits and singularity follow one another");
  const double moved = ledger.known ? (p_ST - last_p_ST_).norm() : 0.0;
  speed_ += (moved - speed_ * dt) / std::max(kSmoothed, dt);
  if (!ledger.known) speed_ = 0.0;
  last_p_ST_ = p_ST;
  bool acts = false;
  for (auto i = kReach; i <= kSingular; ++i) {
    acts |= ledger.why[static_cast<std::size_t>(i)] != Reason::kNone;
  }
  if (!ledger.known || !acts) {
    lasted_ = 0.0;
    return Cue::kNone;
  }
  const double back = ledger.off_S.middleCols<3>(kReach).rowwise().sum().norm();
  const double allowed = (lasted_ > kPatience ? kEnds : kBegins) + kLag * speed_;
  lasted_ = back >= allowed ? std::min(lasted_ + dt, 1.0) : 0.0;
  if (lasted_ <= kPatience) return Cue::kNone;
  const double singular = ledger.off_S.col(kSingular).squaredNorm();
  return 4.0 * singular > back * back ? Cue::kSingularity : Cue::kLimit;
}

double CuePlayer::step(Cue news, Cue lasting, double dt) noexcept {
  age_ = std::min(age_ + dt, 10.0);
  if (news != Cue::kNone) next_ = news;
  const Pattern p = pattern_of(cue_);
  if (within_tremble(p, age_) < 0.0) {
    const Cue begins = next_ != Cue::kNone ? next_ : age_ >= p.length ? lasting : Cue::kNone;
    if (begins != Cue::kNone) {
      cue_ = begins;
      next_ = Cue::kNone;
      age_ = 0.0;
    }
  }
  return cue_force(cue_, age_);
}

Cue CuePlayer::plays() const noexcept { return age_ < pattern_of(cue_).length ? cue_ : Cue::kNone; }

bool CuePlayer::trembles() const noexcept { return within_tremble(pattern_of(cue_), age_) >= 0.0; }

void CuePlayer::cut(Cue news) noexcept {
  if (news != Cue::kNone) next_ = news;
  cue_ = Cue::kNone;
}

}  // namespace handrail
