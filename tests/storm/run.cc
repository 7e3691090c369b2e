#include "tests/storm/run.h"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <csignal>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/units.h"
#include "server/kinematics/rv2a.h"

namespace handrail::storm {
namespace {

constexpr Nanos kTick = 10 * kMillisecond;
constexpr Nanos kStatusPatience = 500 * kMillisecond;
constexpr Nanos kOrderPatience = 10 * kSecond;
constexpr Nanos kRecoverPatience = 10 * kSecond;  // a lost robot takes 1.4 s, a good link 1 s
// From what ends a motion to its end: 20 ms until it is noticed, a cycle, v/a + 2.5 a/j = 0.2 s of
// the slowest joint, and 70 ms for a machine that schedules nobody in time.
constexpr Nanos kStopTime = 300 * kMillisecond;
constexpr Nanos kLeadPatience = 10 * kSecond;  // for hand and arm to be where they are led
constexpr double kLed = 0.010;       // of the command from its goal: friction, 2.5 mm of hand [m]
constexpr double kSettled = 0.0002;  // of the command between two looks, 50 ms apart [m]
constexpr double kFollowed = 0.001;  // of the arm from the command, at rest [m]
constexpr double kTurned = 0.5 * kDeg;  // and how far turned from it

bool led(const pb::Status& s) { return s.state() == "engaged" && s.slave_state() == "engaged"; }
bool left(const std::string& state) { return state == "off" || state == "fault"; }

}  // namespace

Run::Run(const Sequence& sequence, bool (*interrupted)(),
         std::function<void(const Cell& cell)> look)
    : sequence_(sequence),
      interrupted_(interrupted),
      look_(std::move(look)),
      cell_(sequence),
      client_(cell_.socket()),
      random_(sequence.seed + 1) {}

bool Run::over() const { return ended_ || interrupted_(); }
void Run::tell(const std::string& what) { outcome_.story.push_back({monotonic_now(), what}); }
void Run::violated(const std::string& what) {
  outcome_.violations.push_back({monotonic_now(), what});
  tell("VIOLATED: " + what);
}

Outcome Run::go() {
  outcome_.start = monotonic_now();
  storm();
  outcome_.complete = !interrupted_();
  for (const Who who : {Who::kMaster, Who::kSlave, Who::kRig}) {
    if (!cell_.running(who)) continue;
    cell_.send(who, SIGKILL);
    (void)cell_.wait_for_end(who);
  }
  if (forbidden_now_) allow();
  for (const std::string& path : cell_.taps()) {
    const Result<TapFile> tap = read_tap(path);
    if (tap) outcome_.figures.add(judge_tap(*tap, forbidden_, outcome_.violations));
  }
  std::stable_sort(outcome_.violations.begin(), outcome_.violations.end(),
                   [](const Violation& a, const Violation& b) { return a.at < b.at; });
  outcome_.seconds = to_seconds(monotonic_now() - outcome_.start);
  return outcome_;
}

void Run::storm() {
  forbid("nobody had engaged");
  for (const Who who : {Who::kRig, Who::kSlave, Who::kMaster}) {
    if (!start(who)) return;
  }
  if (!recover()) return;
  driving_ = true;
  live(monotonic_now() + 300 * kMillisecond);
  for (const Act& act : sequence_.acts) {
    live(monotonic_now() + act.after);
    if (over()) return;
    apply(act);
    if (!act.recover) continue;
    if (!recover()) return;
    driving_ = true;
  }
  live(monotonic_now() + 300 * kMillisecond);
  for (int attempt = 0; attempt < 4 && !over(); ++attempt) {
    if (!recover()) return;
    driving_ = true;
    live(monotonic_now() + 300 * kMillisecond);
    const std::size_t before = outcome_.violations.size();
    if (follow() || outcome_.violations.size() > before) return;
  }
  if (!over()) violated("engaged four times, and each time it ended by itself");
  return;
}

bool Run::start(Who who) {
  const Status started = cell_.start(who);
  if (started) return true;
  violated(started.message());
  ended_ = true;
  return false;
}

void Run::apply(const Act& act) {
  tell(text(act));
  const Nanos now = monotonic_now();
  const std::vector<Who> whom = act.who == Who::kComputer
                                    ? std::vector<Who>{Who::kMaster, Who::kSlave}
                                    : std::vector<Who>{act.who};
  switch (act.what) {
    case What::kPause:
      for (const Who who : whom) cell_.pause(who);
      live(now + act.lasts);
      if (cell_.paused(Who::kMaster) && act.lasts > kStopTime) {
        forbidden_.push_back({now + kStopTime, monotonic_now(), "the master was paused"});
      }
      for (const Who who : whom) cell_.resume(who);
      return;
    case What::kUnplug:
      cell_.send(Who::kRig, SIGUSR2);
      live(now + act.lasts);
      return cell_.send(Who::kRig, SIGUSR2);
    case What::kKill:
    case What::kTerm: return restart(act);
    case What::kStop: return stop();
  }
}

void Run::restart(const Act& act) {
  away_ = act.who;
  cell_.send(act.who, act.what == What::kKill ? SIGKILL : SIGTERM);
  const int expected = act.what == What::kKill ? -SIGKILL : 0;
  const int code = cell_.wait_for_end(act.who);
  if (code != expected) {
    violated(fmt::format("{} ended with {}, expected {}", name(act.who), code, expected));
  }
  if (act.who == Who::kMaster) client_.close();
  // Each tells the other; what neither remembers is over, and an operator has to engage anyway.
  std::erase(stopped_, act.who);
  if (act.who != Who::kRig) forbid(std::string("the ") + name(act.who) + " had ended");
  live(monotonic_now() + act.lasts);
  if (!over()) (void)start(act.who);
  away_.reset();
}

void Run::stop() {
  std::string said;
  stopped_ = {Who::kMaster, Who::kSlave};
  const bool done = order("stop: true", said);
  if (done && said.find("the slave has it") != std::string::npos) forbid("the stop was confirmed");
}

// Literally what `handrail why` says, until the arm is led.
bool Run::recover() {
  driving_ = false;
  const Nanos give_up = monotonic_now() + kRecoverPatience;
  std::string before, last;
  while (!over()) {
    const auto now = status();
    if (now && led(*now)) return true;
    const std::string way = now ? now->ledger().way_out() : "";
    if (now) last = now->ledger().sentence() + "; way out: " + (way.empty() ? "none" : way);
    if (now && last != before) tell("why: " + last);
    before = last;
    if (monotonic_now() > give_up) {
      violated("not drivable by its way out: " + (last.empty() ? "no master answers" : last));
      return false;
    }
    follow_way_out(way);
    live(monotonic_now() + 100 * kMillisecond);
  }
  return false;
}

void Run::follow_way_out(const std::string& way) {
  const auto says = [&way](const char* word) { return way.find(word) != std::string::npos; };
  std::string said;
  if (says("controller")) {
    tell("alarm reset at the controller");
    cell_.send(Who::kRig, SIGUSR1);
    live(monotonic_now() + 50 * kMillisecond);
  }
  if (says("reset")) {
    // One that the slave has not followed in time still counts: it acts when the slave can.
    (void)order("reset: true", said);
    stopped_.clear();
  }
  if (says("engage") && !says("engage --hold")) {
    if (stopped_.empty()) allow();
    if (order("engage: true", said)) {
      led_ = true;
    } else {
      forbid("engage was refused: " + said);
    }
  }
}

// With the clutch held, so that the device then reaches all of the region.
bool Run::bring_hand_home() {
  std::string said;
  if (!order("clutch: true", said)) return false;
  const Nanos give_up = monotonic_now() + kLeadPatience;
  while (!over() && monotonic_now() < give_up) {
    const auto now = status();
    if (now && (left(now->state()) || left(now->slave_state()))) return false;
    if (now && !now->hand_moving()) {
      if (kScale * pose_of(now->hand()).p.norm() < kLed) return order("clutch: false", said);
      (void)order(order_home(*now, 0.2), said);
    }
    live(monotonic_now() + 20 * kMillisecond);
  }
  if (!over()) violated("the hand does not come to the middle of its device");
  return false;
}

// By the encoders, as the tap has them; nothing when it has nothing of the present.
std::optional<Pose> Run::measured_tip() const {
  const Result<TapFile> tap = read_tap(cell_.taps().back());
  JointVector q;
  if (!tap || !measured_at(*tap, monotonic_now(), q)) return std::nullopt;
  return forward(ArmGeometry(), q);
}

// Until the command is at the goal and the arm, by its own encoders, at the command; false when it
// is not led any more.
bool Run::lead_to(const Pose& goal) {
  const Nanos give_up = monotonic_now() + kLeadPatience;
  Vec3 before = Vec3::Constant(1e3);  // of the command
  std::string why, said;
  bool asked = false;
  while (!over()) {
    const auto now = status();
    if (now && (left(now->state()) || left(now->slave_state()))) return false;
    if (!now) {
      why = "the master does not answer";
    } else if (!led(*now)) {
      why = fmt::format("master {}, slave {}: {}", now->state(), now->slave_state(),
                        now->ledger().sentence());
    } else if (const Pose command = pose_of(now->command());
               !asked || (!now->hand_moving() && (command.p - before).norm() < kSettled)) {
      const double missing = (goal.p - command.p).norm();
      const auto tip = measured_tip();
      if (!asked || missing > kLed) {
        why = fmt::format("the command is {:.1f} mm from where the hand leads it: {}",
                          missing / kMm, now->ledger().sentence());
        asked = order(order_to(goal, *now, 0.25), said);
      } else if (!tip) {
        why = "the tap has nothing of the last 0.2 s";
      } else {
        const double off = (tip->p - command.p).norm(), turned = tip->q.angularDistance(command.q);
        if (off < kFollowed && turned < kTurned) return true;
        why = fmt::format("{:.1f} mm and {:.1f} deg from the command: {}", off / kMm, turned / kDeg,
                          now->ledger().sentence());
      }
    } else {
      before = command.p;
      why = "the hand does not come to rest";
    }
    if (monotonic_now() > give_up) {
      violated("engaged, but does not follow: " + why);
      return false;
    }
    live(monotonic_now() + 50 * kMillisecond);
  }
  return false;
}

// From wherever the arm stands to the middle of what it reaches, and from there to somewhere far
// from it.
bool Run::follow() {
  driving_ = false;
  const auto side = [this] { return random_.uniform() < 0.5 ? -0.7 : 0.7; };
  const Vec3 place(side(), side(), side()), turn(side(), side(), side());
  if (!bring_hand_home() || !lead_to(region_.middle()) || !lead_to(region_.at(place, turn))) {
    return false;
  }
  tell("follows");
  return true;
}

void Run::live(Nanos until) {
  while (!over() && monotonic_now() < until) {
    if (look_) look_(cell_);
    // A short pause is not prolonged by looking at it.
    if (until - monotonic_now() > 2 * kTick) tick();
    sleep_until(std::min(until, monotonic_now() + kTick));
  }
}

void Run::tick() {
  for (const Who who : {Who::kRig, Who::kSlave, Who::kMaster}) {
    if (who == away_ || cell_.running(who)) continue;
    ended_ = true;
    return violated(fmt::format("{} ended by itself with {}: {}", name(who), cell_.code(who),
                                cell_.output(who)));
  }
  const auto now = status();
  if (!now) return;
  observe(*now);
  if (driving_ && led_ && !now->hand_moving()) steer(*now);
}

void Run::observe(const pb::Status& s) {
  if (led(s)) led_ = true;
  if (led_ && (left(s.state()) || left(s.slave_state()))) {
    led_ = false;
    forbid(fmt::format("master {} ({}), slave {} ({})", s.state(), s.reason(), s.slave_state(),
                       s.slave_reason()));
  }
}

// To anywhere in the region, fast.
void Run::steer(const pb::Status& s) {
  std::string said;
  const Pose goal = region_.any(random_);
  (void)order(order_to(goal, s, 0.15 + 0.25 * random_.uniform()), said);
}

std::optional<pb::Status> Run::status() {
  if (!cell_.running(Who::kMaster) || cell_.paused(Who::kMaster)) return std::nullopt;
  pb::Request request;
  request.set_status(true);
  const Result<pb::Reply> reply = client_.call(request, kStatusPatience);
  if (!reply || !reply->done()) return std::nullopt;
  return reply->status();
}

bool Run::order(const std::string& text, std::string& said) {
  if (!cell_.running(Who::kMaster) || cell_.paused(Who::kMaster)) return false;
  pb::Request request;
  if (!google::protobuf::TextFormat::ParseFromString(text, &request)) return false;
  const Result<pb::Reply> reply = client_.call(request, kOrderPatience);
  said = reply ? reply->reason() : reply.message();
  const bool done = reply && reply->done();
  const std::string told = text + (done ? " done " : " refused: ") + said;
  if (!request.has_hand() && told != told_) tell(told);
  told_ = told;
  return done;
}

void Run::forbid(const std::string& why) {
  if (!forbidden_now_) {
    forbidden_now_ = Forbidden{monotonic_now() + kStopTime, 0, why};
  }
  led_ = false;
}

void Run::allow() {
  if (!forbidden_now_) return;
  forbidden_now_->to = monotonic_now();
  if (forbidden_now_->to > forbidden_now_->from) forbidden_.push_back(*forbidden_now_);
  forbidden_now_.reset();
}

}  // namespace handrail::storm
