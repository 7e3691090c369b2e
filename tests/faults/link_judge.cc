#include "tests/faults/link_judge.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "server/lab/faults/audit/heard_master.h"
#include "server/lab/faults/audit/joint_audit.h"
#include "server/lab/faults/audit/stop_audit.h"
#include "server/model/rv2a_limits.h"

namespace handrail::faults {
namespace {

constexpr Nanos kOneCause = 200 * kMillisecond;
// How long before a command a machine's lateness can still have its effect: the time of a stop.
constexpr Nanos kLookBack = 300 * kMillisecond;
constexpr double kStandingStep = 1e-6;  // float32 tells no smaller one [rad]
constexpr int kStandingCycles = 14;     // that a command train outlives without an answer
// The master notices with its next tick, a millisecond, and its state is a millisecond old.
constexpr Nanos kNotices = 2 * kMillisecond;

AuditLimits limits_of(Nanos period) {
  AuditLimits out;
  out.joints = rv2a_limits();
  out.max_jerk = out.joints.max_jerk;
  out.period = period;
  return out;
}

JointVector vector_of(const std::array<double, kJoints>& q) {
  return Eigen::Map<const JointVector>(q.data());
}

// The master as its states let it be understood.
class Speaker {
 public:
  Speaker(const WireTruth& truth, const Story& story, const LatenessLog& lateness)
      : truth_(truth), story_(story), lateness_(lateness) {}

  // Tells `heard` of the states that arrived by `now`; `look` before and after each, with its time.
  template <typename Look>
  void until(Nanos now, HeardMaster& heard, AuditReport& report, Look look) {
    for (; next_ < truth_.to_slave.size() && truth_.to_slave[next_].at <= now; ++next_) {
      const FreshState& fresh = truth_.to_slave[next_];
      look(fresh.at);
      deliver(fresh, heard, report);
      look(fresh.at);
    }
  }

 private:
  void deliver(const FreshState& fresh, HeardMaster& heard, AuditReport& report) {
    const auto starts =
        std::upper_bound(story_.master_starts.begin(), story_.master_starts.end(), fresh.sent);
    const auto incarnation = static_cast<std::uint32_t>(starts - story_.master_starts.begin());
    const bool asked = engaging(fresh.at);
    follow_news(fresh.sent, asked);
    // An engagement that an order may begin: it is told twice, as one that begins and one that is.
    if (asked)
      tell(2 * fresh.number, incarnation, SessionState::kAligning, fresh.at, heard, report);
    tell(2 * fresh.number + 1, incarnation, leads_ ? SessionState::kEngaged : SessionState::kHold,
         fresh.at, heard, report);
  }

  void tell(std::uint64_t number, std::uint32_t incarnation, SessionState session, Nanos at,
            HeardMaster& heard, AuditReport& report) {
    MasterState state;
    state.desired = Desired::kEngaged;
    state.state = session;
    heard.sent(number, incarnation, state, false);
    (void)heard.delivered({number, Origin::kGenuine, at}, report);
  }

  bool engaging(Nanos at) {
    const auto& all = story_.engages;
    while (engage_ < all.size() && all[engage_].to < at) ++engage_;
    return engage_ < all.size() && all[engage_].from <= at;
  }

  // What the master heard by `sent`.
  void follow_news(Nanos sent, bool asked) {
    const auto& news = truth_.to_master;
    Nanos gap = 0;
    for (; news_ < news.size() && news[news_] <= sent; ++news_) {
      if (news_ > 0) gap = std::max(gap, news[news_] - news[news_ - 1]);
    }
    const Nanos age = news_ == 0 ? kForever : sent - news[news_ - 1];
    const Nanos late = kNotices + lateness_.worst(sent - kLookBack, sent);
    lost_ = !asked && (lost_ || std::max(age, gap) > HeardMaster::kLatch + late);
    leads_ = !lost_ && age <= HeardMaster::kWatchdog + late;
  }

  const WireTruth& truth_;
  const Story& story_;
  const LatenessLog& lateness_;
  std::size_t next_ = 0, news_ = 0, engage_ = 0;
  bool lost_ = false, leads_ = false;
};

// What was heard, and when that last let the arm move.
class Hearing {
 public:
  Hearing(const WireTruth& truth, const Story& story, const LatenessLog& lateness)
      : story_(story), speaker_(truth, story, lateness) {
    master_.must_stop(0);  // nobody has engaged
  }
  // Goes on to `at`, by the clock of who is `late`.
  void until(Nanos at, Nanos late, AuditReport& report) {
    const auto& all = story_.must_stop;
    while (stop_ < all.size() && all[stop_] <= at) master_.must_stop(all[stop_++]);
    const auto look = [&](Nanos now) { judge(now, late, report); };
    speaker_.until(at, master_, report, look);
    look(at);
  }
  const HeardMaster& master() const { return master_; }
  // By what was heard at the end, or a command's way before: later news are not yet in a command.
  bool led_lately(Nanos at) const { return at - led_at_ <= StopAudit::kOverhead; }

 private:
  void judge(Nanos now, Nanos late, AuditReport& report) {
    const bool was_led = master_.led();
    master_.judge(now - late, report);
    const HeardMaster::Cause cause = master_.cause_of_stop(now - late);
    if (master_.led())
      led_at_ = now;
    else if (was_led)
      led_at_ = std::min(now, cause.from + cause.due + late);
  }

  const Story& story_;
  Speaker speaker_;
  HeardMaster master_;
  std::size_t stop_ = 0;
  Nanos led_at_ = -kForever;
};

class Judge {
 public:
  Judge(Nanos period, const WireTruth& truth, const Story& story, const LatenessLog& lateness)
      : period_(period),
        lateness_(lateness),
        hearing_(truth, story, lateness),
        stops_(period),
        joints_(limits_of(period)) {}

  void place(const JointVector& q) {
    q_ = q;
    (void)joints_.commanded(q, ignored_);
  }

  void cycle(const TapRecord& r) {
    const bool accepted = r.has(kTapAccepted);
    // When the rig got the command; a cycle without one is judged at its own time.
    const Nanos came = r.at - period_ + static_cast<Nanos>(r.came) * kMicrosecond;
    const Nanos at = accepted ? std::min(came, r.at) : r.at;
    const Nanos late = granted(at);
    hearing_.until(at, late, out_.report);
    const bool led_lately = hearing_.led_lately(at);
    const bool was_at_rest = joints_.at_rest();
    if (led()) held_in_stop_ = 0;
    if (led_lately) stops_.led(out_.report);
    stops_.judge(hearing_.master(), at - late, was_at_rest, joints_.time_to_stop(), out_.report);
    if (!accepted) return hold();
    move_to(vector_of(r.target));
    held_ = 0;
    if (joints_.moving() && !led_lately) unled(at, late, was_at_rest);
  }

  LinkVerdict finish() {
    stops_.finish(out_.report);
    return out_;
  }

 private:
  bool led() const { return hearing_.master().led(); }

  Nanos granted(Nanos at) {
    const Nanos late = lateness_.worst(at - kLookBack, at);
    if (!led() && !joints_.at_rest()) out_.lateness = std::max(out_.lateness, late);
    return late + held_in_stop_ * period_;
  }

  void hold() {
    if (joints_.at_rest()) return;
    ++out_.held;
    ++held_;
    if (!led()) ++held_in_stop_;
    if (held_ < kStandingCycles) return;
    for (int i = 0; i < 3; ++i) (void)joints_.commanded(q_, ignored_);
  }

  // Cycles without a command count as time that passed: the way is spread over them.
  void move_to(const JointVector& target) {
    const bool stands = (target - q_).cwiseAbs().maxCoeff() <= kStandingStep;
    const JointVector q = stands ? q_ : target;
    for (int i = 1; i <= held_; ++i) {
      (void)joints_.commanded(q_ + i / (held_ + 1.0) * (q - q_), ignored_);
    }
    (void)joints_.commanded(q, ignored_);
    q_ = q;
  }

  void unled(Nanos at, Nanos late, bool was_at_rest) {
    const std::uint64_t before = out_.report.total();
    stops_.moved_unled(at - late, was_at_rest, out_.report);
    if (out_.report.total() == before) return;
    if (last_violation_ < 0 || at - last_violation_ > kOneCause) {
      out_.violations.push_back({at, fmt::format("{}; beside the bound {:.1f} ms were granted",
                                                 was_at_rest ? "moved while nobody led it"
                                                             : "still moving after its stop",
                                                 1e3 * to_seconds(late))});
    }
    last_violation_ = at;
  }

  Nanos period_;
  const LatenessLog& lateness_;
  Hearing hearing_;
  StopAudit stops_;
  JointAudit joints_;
  BreachCounts ignored_{};  // limits are ControllerAudit's, which knows what was lost
  LinkVerdict out_;
  JointVector q_ = JointVector::Zero();
  int held_ = 0, held_in_stop_ = 0;
  Nanos last_violation_ = -1;
};

void count_gaps(const WireTruth& truth, const LatenessLog& lateness, LinkVerdict& out) {
  const auto late = [&](Nanos from, Nanos to) { return kNotices + lateness.worst(from, to); };
  // What one side waited for this long may have been 200 ms to it, if the machine was late.
  const auto may_latch = [&](Nanos from, Nanos to) {
    return to - from > std::max(HeardMaster::kWatchdog, HeardMaster::kLatch - late(from, to));
  };
  for (std::size_t i = 1; i < truth.to_slave.size(); ++i) {
    const Nanos from = truth.to_slave[i - 1].at, to = truth.to_slave[i].at, gap = to - from;
    out.longest_gap = std::max(out.longest_gap, gap);
    if (gap > HeardMaster::kWatchdog && gap <= HeardMaster::kLatch) ++out.short_gaps;
    if (gap > HeardMaster::kWatchdog + late(from, to)) ++out.trips;
    if (may_latch(from, to)) ++out.long_gaps;
  }
  for (std::size_t i = 1; i < truth.to_master.size(); ++i) {
    if (may_latch(truth.to_master[i - 1], truth.to_master[i])) ++out.long_gaps;
  }
}

}  // namespace

LinkVerdict judge_link(const TapFile& tap, const WireTruth& truth, const Story& story,
                       const LatenessLog& lateness) {
  Judge judge(tap.period, truth, story, lateness);
  const std::size_t first = storm::first_judged(tap);
  for (std::size_t i = first; i < tap.records.size(); ++i) {
    if (i == first) judge.place(vector_of(tap.records[i].target));
    judge.cycle(tap.records[i]);
  }
  LinkVerdict out = judge.finish();
  count_gaps(truth, lateness, out);
  return out;
}

}  // namespace handrail::faults
