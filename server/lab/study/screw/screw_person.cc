#include "server/lab/study/screw/screw_person.h"

#include <algorithm>
#include <cmath>

namespace handrail {
namespace {

constexpr double kHover = 3e-3;          // the ball end waits this far above the rim [m]
constexpr double kSixth = 60.0 * kDeg;   // a hexagon fits again after it
constexpr double kWiggle = 10.0 * kDeg;  // either way, to feel for the flats
constexpr double kSlowly = 0.5;          // of the turning speed, while feeling for the flats
constexpr double kShallow = 0.35;        // of the way down the flats still counts as in
constexpr double kHardly = 0.5e-3;       // a push of less need not be taken back [m]
// What counts as arrived where the place does not matter [m].
constexpr double kRoughly = 5e-3;
constexpr double kAnywhere = 0.1;

ScrewKey tool_key(ToolKind kind) {
  ScrewKey key;
  key.act = ScrewKey::Act::kTool;
  key.tool.kind = kind;
  return key;
}

// A line both ways along the screw's axis.
ScrewKey screw_line(const Vec3& p_SA, const Vec3& axis) {
  ScrewKey key = tool_key(ToolKind::kLine);
  key.tool.at_present = false;
  key.tool.p_SA = p_SA;
  key.tool.direction_S = axis;
  return key;
}

ScrewKey all_off() {
  ScrewKey key;
  key.act = ScrewKey::Act::kToolsOff;
  return key;
}

}  // namespace

ScrewPerson::ScrewPerson(ScrewPlace& place, const ScrewWork& work, const Compliance& give,
                         const OperatorParameters& person, const ScrewHabits& habits)
    : place_(place),
      work_(work),
      give_(give),
      person_(person),
      habits_(habits),
      q_start_(place.tip().q) {}

void ScrewPerson::fasten() {
  for (bool ok = true; ok;) {
    ok = decide() && start_clock() && insert() && turn() && lift();
    // A key lifted from a tight screw ends the trial when it is clear.
    while (ok && place_.tight()) ok = lift();
    ok = ok && turn_back();
  }
}

bool ScrewPerson::wait(double seconds) {
  const double until = place_.now() + seconds;
  while (place_.now() < until) {
    if (!step()) return false;
  }
  return true;
}

bool ScrewPerson::start_clock() {
  if (!timed_) place_.start_clock();
  timed_ = true;
  return true;
}

// One key press each; the hand goes to the keys once and stays there.
bool ScrewPerson::call(std::initializer_list<ScrewKey> keys) {
  if (!at_keys_ && !wait(person_.call_homing)) return false;
  at_keys_ = true;
  for (const ScrewKey& key : keys) {
    if (!wait(person_.call_key) || !step(key)) return false;
  }
  return true;
}

// Until the operator holds the aim to be reached, or with `until_in` sees the key in. On the line
// only what is left free is minded.
bool ScrewPerson::act(ScrewPhase phase, OperatorAim aim, bool until_in) {
  phase_ = phase;
  if (on_line_) {
    aim.minds_place = work_.out * work_.out.transpose();
    aim.minds_turn = phase == ScrewPhase::kInsert ? Mat3(Mat3::Zero()) : aim.minds_place;
  }
  place_.mind().aim(aim);
  double in_for = 0.0;  // the key has seemed to be in [s]
  do {
    if (!step()) return false;
    in_for = until_in && seems_in() ? in_for + habits_.tick : 0.0;
    if (in_for >= person_.plan_interval) {
      place_.leave_off();
      break;
    }
    if (phase == ScrewPhase::kTurn && place_.tight()) break;
  } while (!place_.mind().arrived());
  return true;
}

// The key's orientation, turned clockwise from where it waited.
Quat ScrewPerson::turned(double angle) const { return rotation_exp(-angle * work_.out) * q_start_; }
// By how much from there its flats fit, the nearest of six.
double ScrewPerson::fitting() const {
  const double now = -rotation_log(place_.tip().q * q_start_.conjugate()).dot(work_.out);
  return std::remainder(now + place_.off_flats(), kSixth);
}

// Looks for the place above the socket.
bool ScrewPerson::align() {
  fit_ = fitting();
  OperatorAim aim;
  aim.X_SG = {work_.above(kHover), turned(fit_)};
  aim.tolerance = person_.insert_tolerance;
  return act(ScrewPhase::kAlign, aim);
}

// Lets the key down by hand, to where it should be in the socket.
bool ScrewPerson::let_down() {
  const double by_sight = work_.height(place_.mind().seen()) + work_.depth + person_.press;
  const double by_memory = place_.mind().meant().dot(work_.out) - known_depth_;
  const double way =
      inserted_before_ ? by_sight + person_.depth_memory * (by_memory - by_sight) : by_sight;
  return act(ScrewPhase::kInsert, by_hand(-std::max(way, 1e-3)));
}

// The hand goes so far along the axis, whatever the key does.
OperatorAim ScrewPerson::by_hand(double up) const {
  OperatorAim aim;
  aim.path = aim.by_hand = true;
  aim.p_S0 = work_.above(0.0);
  aim.X_SG = {work_.above(up), turned(fit_)};
  aim.speed = person_.insert_speed;
  aim.gentle = work_.depth + kHover;
  return aim;
}

// A key that is seen not to be in is pushed by what seems to be missing; what did not help is
// taken back.
bool ScrewPerson::push_on() {
  if (seems_in()) return true;
  const double before = place_.mind().meant().dot(work_.out);
  const double missing = work_.height(place_.mind().seen()) + work_.depth + person_.press;
  if (!act(ScrewPhase::kInsert, by_hand(-missing), true)) return false;
  if (seems_in()) return true;
  const double pushed = before - place_.mind().meant().dot(work_.out);
  return pushed < kHardly || act(ScrewPhase::kInsert, by_hand(pushed));
}

// As far as the eye tells.
bool ScrewPerson::seems_in() const {
  return -work_.height(place_.mind().seen()) >
         work_.depth - kShallow * (work_.depth - work_.chamfer);
}

// Until the ball end seems to be in: beside the socket, or with its corners across, it is not.
bool ScrewPerson::insert() {
  for (;;) {
    if (!line_found_) {
      if (!align()) return false;
      if (habits_.tools &&
          !call({screw_line(place_.told_tip().p, work_.out), tool_key(ToolKind::kNRotation)})) {
        return false;
      }
      on_line_ = habits_.tools;
    } else if (!call({tool_key(ToolKind::kNRotation)})) {
      return false;
    }
    if (!let_down() || !push_on()) return false;
    if (!seems_in() && !seek()) return false;
    if (seems_in()) break;
    ++misses_;
    if (!give_up()) return false;
  }
  known_depth_ = place_.mind().meant().dot(work_.out);
  inserted_before_ = true;
  return true;
}

// Turns the key to and fro until its corners fit and it drops in.
bool ScrewPerson::seek() {
  if (habits_.tools && !call({tool_key(ToolKind::kFRotation)})) return false;
  free_to_turn_ = habits_.tools;
  for (const double turn : {kWiggle, -kWiggle}) {
    OperatorAim aim;
    aim.X_SG = {place_.tip().p, turned(fit_ + turn)};
    aim.tolerance = kAnywhere;
    aim.turn_speed = kSlowly * person_.turn_speed;
    if (!act(ScrewPhase::kSeek, aim, true) || !push_on()) return false;
    if (seems_in()) break;
  }
  return true;
}

bool ScrewPerson::give_up() {
  if (habits_.tools && !call({all_off()})) return false;
  on_line_ = line_found_ = false;
  free_to_turn_ = false;
  OperatorAim aim;
  aim.X_SG = {work_.above(kHover), turned(fit_)};
  return act(ScrewPhase::kAlign, aim);
}

bool ScrewPerson::turn() {
  if (habits_.tools) {
    // Where the key stands, less what it is bent: the line is not to load it.
    const Vec3 straight = place_.told_tip().p + give_.at(place_.told_tip().q) * place_.told_force();
    if (!line_found_ && !call({screw_line(straight, work_.out)})) return false;
    line_found_ = true;
    if (!free_to_turn_ && !call({tool_key(ToolKind::kFRotation)})) return false;
    free_to_turn_ = false;
  }
  OperatorAim aim;
  aim.X_SG = {work_.above(-work_.depth), turned(fit_ + person_.half_turn)};
  aim.way_round = -work_.out;
  aim.tolerance = person_.insert_tolerance;  // the key is watched to stay down
  return act(ScrewPhase::kTurn, aim);
}

bool ScrewPerson::lift() {
  OperatorAim aim;
  aim.path = true;
  aim.p_S0 = work_.above(-work_.depth);
  const double up =
      place_.tight() ? std::max(person_.lift, work_.task.clear) + kRoughly : person_.lift;
  aim.X_SG = {work_.above(up), place_.tip().q};
  aim.tolerance = kRoughly;
  return act(ScrewPhase::kLift, aim);
}

bool ScrewPerson::turn_back() {
  fit_ = fitting();
  OperatorAim aim;
  aim.X_SG = {work_.above(person_.lift), turned(fit_)};
  aim.way_round = work_.out;
  aim.tolerance = kRoughly;
  return act(ScrewPhase::kReturn, aim);
}

}  // namespace handrail
