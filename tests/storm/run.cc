#include "tests/storm/run.h"

#include <google/protobuf/text_format.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <csignal>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/units.h"
#include "server/control/mapping.h"
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
// Where the hand leads the tip: to any side of where it stands at first, free of any limit [m].
const Vec3 kBox(0.040, 0.060, 0.040);
const Vec3 kHandRange(0.070, 0.050, 0.030);   // of the device, 5 mm inside [m]
constexpr double kScale = 3.0;                // of the scene
constexpr double kTurn = 0.3;                 // of the tip to any side [rad]
constexpr double kCheckWay = 0.030;           // that the arm is led to see that it follows [m]
constexpr double kFollowed = 0.001;           // from the command, at rest [m]
constexpr Nanos kRestPatience = 3 * kSecond;  // for the arm to be there

MappingSettings mapping() {
  MappingSettings out;
  out.scale = kScale;
  return out;
}

Pose pose(const pb::PoseMm& in) {
  Pose out;
  if (in.position_mm_size() == 3) {
    out.p = kMm * Vec3(in.position_mm(0), in.position_mm(1), in.position_mm(2));
  }
  if (in.quaternion_size() == 4) {
    out.q = Quat(in.quaternion(0), in.quaternion(1), in.quaternion(2), in.quaternion(3));
  }
  return out;
}

// Which way the hand is to go for the tip to go by `d_S`; no further than the device reaches.
Vec3 hand_way(const pb::Status& status, const Vec3& d_S) {
  const Vec3 hand = pose(status.hand()).p;
  const Vec3 goal = hand + Engagement(mapping(), Pose(), Pose()).to_hand(d_S);
  return goal.cwiseMax(-kHandRange).cwiseMin(kHandRange) - hand;
}

// Where the rig's arm stands at first.
Pose start_of_tip() { return forward(ArmGeometry(), ServoArmOptions::default_start()); }

std::string hand_order(const Vec3& way_M, const Vec3& turn_M, double seconds) {
  return fmt::format(
      "hand {{ displacement_mm: [{}, {}, {}] rotation_deg: [{}, {}, {}] duration_s: {} }}",
      way_M.x() / kMm, way_M.y() / kMm, way_M.z() / kMm, turn_M.x() / kDeg, turn_M.y() / kDeg,
      turn_M.z() / kDeg, seconds);
}

Vec3 rotation_vector(const Quat& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

bool led(const pb::Status& s) { return s.state() == "engaged" && s.slave_state() == "engaged"; }
bool left(const std::string& state) { return state == "off" || state == "fault"; }

}  // namespace

Run::Run(const Sequence& sequence, bool (*interrupted)())
    : sequence_(sequence),
      interrupted_(interrupted),
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
    case What::kTerm:
      return restart(act);
    case What::kStop:
      return stop();
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
  if (act.who != Who::kRig) forbid(std::string("the ") + name(act.who) + " had ended");
  live(monotonic_now() + act.lasts);
  if (!over()) (void)start(act.who);
  away_.reset();
}

void Run::stop() {
  std::string said;
  stopped_ = true;
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
    stopped_ = false;
  }
  if (says("engage") && !says("engage --hold")) {
    if (!stopped_) allow();
    if (order("engage: true", said)) {
      led_ = true;
    } else {
      forbid("engage was refused: " + said);
    }
  }
}

// Until the hand rests and the arm is where it is led, by its own encoders; nothing when it is not
// led any more.
std::optional<Run::Rest> Run::at_rest() {
  const Nanos give_up = monotonic_now() + kRestPatience;
  live(monotonic_now() + 500 * kMillisecond);
  while (!over()) {
    const auto now = status();
    if (now && (left(now->state()) || left(now->slave_state()))) return std::nullopt;
    const Result<TapFile> tap = read_tap(cell_.taps().back());
    JointVector q;
    std::string why = "the master does not answer, or the tap has nothing of the last 0.2 s";
    if (now && tap && measured_at(*tap, monotonic_now(), q)) {
      const Rest rest{*now, forward(ArmGeometry(), q).p};
      const double off = (rest.tip - pose(now->command()).p).norm();
      if (led(*now) && !now->hand_moving() && off < kFollowed) return rest;
      why = fmt::format("master {}, slave {}, {:.1f} mm from the command: {}", now->state(),
                        now->slave_state(), off / kMm, now->ledger().sentence());
    }
    if (monotonic_now() > give_up) {
      violated("engaged, but does not follow: " + why);
      return std::nullopt;
    }
    live(monotonic_now() + 100 * kMillisecond);
  }
  return std::nullopt;
}

// Toward the middle of what hand and arm can do.
Vec3 Run::way_to_check(const pb::Status& s) const {
  Vec3 way = Vec3::Zero();
  double least = 1e9;
  for (int i = 0; i < 6; ++i) {
    const Vec3 d = (i < 3 ? kCheckWay : -kCheckWay) * Vec3::Unit(i % 3);
    const Vec3 hand = pose(s.hand()).p + Engagement(mapping(), Pose(), Pose()).to_hand(d);
    const Vec3 tip = pose(s.command()).p + d - start_of_tip().p;
    const double off = std::max(tip.cwiseQuotient(kBox).cwiseAbs().maxCoeff(),
                                hand.cwiseQuotient(kHandRange).cwiseAbs().maxCoeff());
    if (off < least) way = d;
    least = std::min(least, off);
  }
  return way;
}

bool Run::follow() {
  driving_ = false;
  const auto before = at_rest();
  if (!before) return false;
  std::string said;
  const Vec3 way_M = hand_way(before->status, way_to_check(before->status));
  if (!order(hand_order(way_M, Vec3::Zero(), 0.4), said)) return false;
  const auto after = at_rest();
  if (!after) return false;
  const Vec3 asked = pose(after->status.command()).p - pose(before->status.command()).p;
  const Vec3 moved = after->tip - before->tip;
  const std::string what = fmt::format("the command went {:.1f} mm, the arm {:.1f} mm",
                                       asked.norm() / kMm, moved.norm() / kMm);
  // The device's friction keeps some of what the hand means to do.
  if (asked.norm() < 0.5 * kCheckWay || moved.norm() < 0.5 * kCheckWay) {
    violated(fmt::format("engaged, but does not follow: of {:.0f} mm {}: {}", kCheckWay / kMm, what,
                         after->status.ledger().sentence()));
    return false;
  }
  tell("follows: " + what);
  return true;
}

void Run::live(Nanos until) {
  while (!over() && monotonic_now() < until) {
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

// To anywhere in the box, turned anyhow, fast.
void Run::steer(const pb::Status& s) {
  const auto any = [this] {
    return Vec3(2.0 * random_.uniform() - 1.0, 2.0 * random_.uniform() - 1.0,
                2.0 * random_.uniform() - 1.0);
  };
  const Pose U = pose(s.command());
  const Vec3 way = hand_way(s, start_of_tip().p + any().cwiseProduct(kBox) - U.p);
  const Vec3 turn = kTurn * any();
  const Quat goal = Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * start_of_tip().q;
  const Vec3 turn_S = rotation_vector(goal * U.q.conjugate());
  const Vec3 turn_M = Engagement(mapping(), Pose(), Pose()).turn_to_hand(turn_S);
  std::string said;
  (void)order(hand_order(way, turn_M, 0.15 + 0.25 * random_.uniform()), said);
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
