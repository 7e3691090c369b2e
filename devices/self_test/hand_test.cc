#include "devices/self_test/hand_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "server/base/units.h"

namespace handrail {
namespace {

// All our choice: long enough for a person, and for a device that was just let go of.
constexpr Nanos kPersonPatience = 15 * kSecond;
constexpr Nanos kLeftAlone = 1500 * kMillisecond;
constexpr Nanos kQuiet = 200 * kMillisecond;  // so long slow: at rest
constexpr double kSlow = 0.02;                // a hand that holds something trembles below it [m/s]
constexpr Nanos kLongestUnrest = 10 * kSecond;
constexpr Nanos kGone = 5 * kSecond;   // without a valid reading: the device is gone
constexpr double kMostDrift = 3e-3;    // while it is left alone [m]
constexpr double kAsideShare = 1.5;    // the way asked for is so much longer than any other
constexpr double kLeastWay = 5 * kMm;  // more than a hand wanders
constexpr double kTurnAsked = 10.0 * kDeg;
// A tenth of it is still a hand that feels smooth; below, a device is not what it is said to be.
constexpr double kLeastRate = 50.0;    // readings that are new while it moves [1/s]
constexpr double kMovingSpeed = 5e-3;  // [m/s]
constexpr Nanos kRampUp = kSecond, kHeld = kSecond, kRampDown = 300 * kMillisecond;
constexpr double kLeastGiven = 1e-3;  // that counts as having given way [m]
constexpr double kRunsAway = 0.5;     // [m/s]

constexpr std::array kWays = {"right", "up", "toward you"};
constexpr std::array kBackWays = {"left", "down", "away from you"};
constexpr std::array kMoveChecks = {"move.right", "move.up", "move.toward"};
constexpr std::array kTurnChecks = {"turn.right", "turn.up", "turn.toward"};
constexpr std::array kForceChecks = {"force.right", "force.up", "force.toward"};
constexpr std::array kTurnWords = {"tip its top toward you",
                                   "turn it counter-clockwise as seen from above",
                                   "tip its top to the left"};
constexpr std::array kButtonWords = {"1 (clutch)", "2 (drops the tool)", "3 (dead-man)"};

template <typename... Values>
std::string written(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// The axis along which `v` is longest.
int longest(const Vec3& v) {
  int axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return axis;
}

// "12.3 mm right, 1.0 mm down, 0.2 mm away from you".
std::string way_text(const Vec3& v) {
  std::string out;
  for (int i = 0; i < 3; ++i) {
    out += written("%s%.1f mm %s", out.empty() ? "" : ", ", std::abs(v[i]) / kMm,
                   v[i] < 0.0 ? kBackWays[at(i)] : kWays[at(i)]);
  }
  return out;
}

std::string turn_text(const Vec3& v) {
  return written("%.0f, %.0f, %.0f deg about right, up, toward you", v[0] / kDeg, v[1] / kDeg,
                 v[2] / kDeg);
}

double asked_way(const HapticCapabilities& c, int axis) {
  return std::clamp(0.25 * c.workspace_half[axis], kLeastWay, 20 * kMm);
}

}  // namespace

HandTest::HandTest(std::unique_ptr<HapticDevice> device, const TestWishes& wishes,
                   std::string block, const std::array<bool, 3>& turns)
    : device_(std::move(device)), block_(std::move(block)) {
  plan(wishes, turns);
}

void HandTest::plan(const TestWishes& wishes, const std::array<bool, 3>& turns) {
  const HapticCapabilities& c = device_->capabilities();
  steps_.push_back({Kind::kStill, 0});
  const bool plays = c.simulated && device_->hand() == nullptr;
  if (!wishes.alone && !plays) {
    for (int i = 0; i < 3; ++i) {
      // Some move in a plane alone.
      if (c.workspace_half[i] >= kLeastWay) steps_.push_back({Kind::kMove, i});
    }
    if (c.senses_rotation) {
      for (int i = 0; i < 3; ++i) {
        if (turns[at(i)]) steps_.push_back({Kind::kTurn, i});
      }
    }
    // A page's dead-man is its mouse button, which no simulated hand has.
    const int buttons = std::min(c.buttons, c.led_by_cursor ? 2 : 3);
    for (int i = 0; i < buttons; ++i) steps_.push_back({Kind::kButton, i});
  }
  if (!(wishes.force > 0.0)) return;
  if (!(c.max_force > 0.0)) {
    done_.push_back({"force", Verdict::kBad, c.name + " makes no force", "leave out --force"});
  } else if (wishes.alone) {
    done_.push_back({"force", Verdict::kNotSeen, "nobody is there to hold it",
                     "leave out --alone, and hold it loosely"});
  } else if (!plays) {
    force_ = std::min(wishes.force, c.continuous_force);
    for (int i = 0; i < 3; ++i) {
      if (c.workspace_half[i] >= kLeastWay) steps_.push_back({Kind::kForce, i});
    }
  }
}

bool HandTest::turn(Nanos now) {
  const HapticSample sample = device_->read(now);
  if (!started_) {
    started_ = true;
    last_ = valid_at_ = step_began_ = quiet_since_ = now;
  }
  ++all_;
  if (sample.valid) {
    note(sample, now);
    if (now_at_ < steps_.size()) step(sample, now);
    before_ = sample;
    valid_at_ = now;
  } else {
    ++invalid_;
    pushed_.setZero();
    if (now - valid_at_ > kGone) lost_ = "no valid reading for 5 s";
  }
  last_ = now;
  const bool goes_on = lost_.empty() && now_at_ < steps_.size();
  device_->write({goes_on ? pushed_ : Vec3::Zero().eval(), Vec3::Zero()});
  return goes_on;
}

void HandTest::note(const HapticSample& sample, Nanos now) {
  if (valid_at_ != last_ || sample.v_MH.norm() < kMovingSpeed) return;
  moving_s_ += to_seconds(now - last_);
  ++while_moving_;
  if (sample.X_MH.p != before_.X_MH.p) ++new_ones_;
}

bool HandTest::settled(const HapticSample& sample, Nanos now) {
  if (sample.v_MH.norm() > kSlow) quiet_since_ = now;
  return now - quiet_since_ >= kQuiet || now - step_began_ >= kLongestUnrest;
}

void HandTest::begin_step(const HapticSample& sample, Nanos now) {
  armed_ = true;
  step_began_ = now;
  origin_ = sample.X_MH;
  least_ = most_ = sample.X_MH.p;
  push_ended_ = kForever;
  steer_hand();
}

// A simulated hand does as it is asked.
void HandTest::steer_hand() {
  SteerableHand* const hand = device_->hand();
  const Step& asked = steps_[now_at_];
  if (hand == nullptr || asked.kind == Kind::kStill || asked.kind == Kind::kForce) return;
  HandIntent intent;
  intent.duration = 0.5;
  if (asked.kind == Kind::kMove) {
    intent.displacement_M[asked.which] = 1.5 * asked_way(device_->capabilities(), asked.which);
  } else if (asked.kind == Kind::kTurn) {
    intent.rotation_M[asked.which] = 2.0 * kTurnAsked;
  } else {
    intent.buttons = 1u << asked.which;
  }
  hand->steer(intent);
}

void HandTest::step(const HapticSample& sample, Nanos now) {
  if (!armed_) {
    // A button may be pressed at once.
    if (steps_[now_at_].kind != Kind::kButton && !settled(sample, now)) return;
    begin_step(sample, now);
  }
  switch (steps_[now_at_].kind) {
    case Kind::kStill: step_still(sample, now); break;
    case Kind::kMove:
    case Kind::kTurn: step_way(sample, now); break;
    case Kind::kButton: step_button(sample); break;
    case Kind::kForce: step_force(sample, now); break;
  }
  if (armed_ && now - step_began_ >= kPersonPatience) {
    end_step(Verdict::kNotSeen, "asked to " + request() + ": nothing came of it in 15 s",
             "try anew; with --alone nothing is asked");
  }
}

void HandTest::step_still(const HapticSample& sample, Nanos now) {
  least_ = least_.cwiseMin(sample.X_MH.p);
  most_ = most_.cwiseMax(sample.X_MH.p);
  if (now - step_began_ < kLeftAlone) return;
  const double way = (most_ - least_).norm();
  const bool still = way <= kMostDrift;
  end_step(still ? Verdict::kOk : Verdict::kBad,
           written("moved within %.2f mm in 1.5 s while left alone, at most %.0f mm expected",
                   way / kMm, kMostDrift / kMm),
           still ? "" : "let go of it and try anew; if it drifts by itself, calibrate it");
}

void HandTest::step_way(const HapticSample& sample, Nanos) {
  const Step& asked = steps_[now_at_];
  const bool moves = asked.kind == Kind::kMove;
  const Vec3 way =
      moves ? Vec3(sample.X_MH.p - origin_.p) : rotation_log(sample.X_MH.q * origin_.q.conjugate());
  const int axis = longest(way);
  const double wanted = moves ? asked_way(device_->capabilities(), axis) : kTurnAsked;
  const double far = std::abs(way[axis]);
  if (far < wanted) return;
  Vec3 rest = way;
  rest[axis] = 0.0;
  const std::string fact = moves ? way_text(way) : turn_text(way);
  if (far < kAsideShare * rest.cwiseAbs().maxCoeff()) {
    if (far < 3.0 * wanted) return;
    return end_step(Verdict::kNotSeen, "it went aslant: " + fact,
                    "try anew, along one axis at a time");
  }
  if (axis == asked.which && way[axis] > 0.0) return end_step(Verdict::kOk, fact, "");
  end_step(Verdict::kBad, "asked to " + request() + ", it went " + fact,
           "if you did as asked, its axes are not those of Handrail's frame: how does it stand?");
}

void HandTest::step_button(const HapticSample& sample) {
  const std::uint32_t wanted = 1u << steps_[now_at_].which;
  // A dead-man or a clutch may be held from before.
  const std::uint32_t pressed = sample.buttons & ~before_.buttons;
  if (pressed & wanted) return end_step(Verdict::kOk, "pressed", "");
  if (pressed == 0) return;
  int other = 0;
  while ((pressed >> other & 1u) == 0) ++other;
  end_step(Verdict::kBad, written("button %d went down instead", other + 1),
           "if you pressed the right one, name its number in the configuration");
}

void HandTest::step_force(const HapticSample& sample, Nanos now) {
  const int axis = steps_[now_at_].which;
  const Vec3 way = sample.X_MH.p - origin_.p;
  const double far = 0.5 * device_->capabilities().workspace_half[axis];
  const bool over = now - step_began_ >= kRampUp + kHeld;
  pushed_.setZero();
  if (push_ended_ == kForever) {
    const bool flees = way.norm() > far || sample.v_MH.norm() > kRunsAway;
    if (!over && !flees) {
      pushed_[axis] = force_ * std::min(1.0, to_seconds(now - step_began_) / to_seconds(kRampUp));
      return;
    }
    push_ended_ = now;
    last_push_ = flees ? 0.0 : force_;
    gave_way_ = way;
  }
  const Nanos since = now - push_ended_;
  if (since < kRampDown) {
    pushed_[axis] = last_push_ * (1.0 - to_seconds(since) / to_seconds(kRampDown));
    return;
  }
  const std::string fact = written("with up to %.2f N it gave way ", force_) + way_text(gave_way_);
  if (gave_way_[axis] >= kLeastGiven) return end_step(Verdict::kOk, fact, "");
  if (gave_way_[axis] <= -kLeastGiven) {
    return end_step(Verdict::kBad, fact + ", and the force was to push it " + kWays[at(axis)],
                    "the force is reversed: do not use it");
  }
  end_step(Verdict::kNotSeen, fact, "hold it more loosely, or ask for more force");
}

void HandTest::end_step(Verdict verdict, std::string fact, std::string next) {
  const Step& ended = steps_[now_at_];
  std::string check;
  switch (ended.kind) {
    case Kind::kStill: check = "still"; break;
    case Kind::kMove: check = kMoveChecks[at(ended.which)]; break;
    case Kind::kTurn: check = kTurnChecks[at(ended.which)]; break;
    case Kind::kButton: check = "button." + std::to_string(ended.which + 1); break;
    case Kind::kForce: check = kForceChecks[at(ended.which)]; break;
  }
  done_.push_back({check, verdict, std::move(fact), std::move(next)});
  pushed_.setZero();
  armed_ = false;
  step_began_ = quiet_since_ = last_;
  ++now_at_;
}

std::string HandTest::asks() const {
  // A simulated hand needs no words.
  if (now_at_ >= steps_.size() || device_->hand() != nullptr) return {};
  // Who is told what comes next begins at once, and where it began would not be known.
  return armed_ || steps_[now_at_].kind == Kind::kButton ? request() : "hold it still";
}

std::string HandTest::request() const {
  const Step& asked = steps_[now_at_];
  switch (asked.kind) {
    case Kind::kStill: return "leave it alone";
    case Kind::kMove: return std::string("move it ") + kWays[at(asked.which)];
    case Kind::kTurn: return kTurnWords[at(asked.which)];
    case Kind::kButton: return std::string("press button ") + kButtonWords[at(asked.which)];
    case Kind::kForce:
      return written("hold it loosely: up to %.2f N %s", force_, kWays[at(asked.which)]);
  }
  return {};
}

TestItem HandTest::readings() const {
  if (!lost_.empty()) {
    return {"readings", Verdict::kBad, lost_, "is it plugged in? handrail devices list"};
  }
  const double share =
      all_ == 0 ? 0.0 : 100.0 * static_cast<double>(invalid_) / static_cast<double>(all_);
  return {"readings",
          all_ == 0     ? Verdict::kNotSeen
          : share > 1.0 ? Verdict::kBad
                        : Verdict::kOk,
          written("%llu readings, %.1f %% of them not valid, at most 1 %% expected",
                  static_cast<unsigned long long>(all_), share),
          share > 1.0 ? "look at plug and cable" : ""};
}

TestItem HandTest::rate() const {
  const double rate = static_cast<double>(new_ones_) / moving_s_;
  return {"rate", rate < kLeastRate ? Verdict::kBad : Verdict::kOk,
          written("while it moved, %.0f of %.0f readings a second were new, at least %.0f expected",
                  rate, static_cast<double>(while_moving_) / moving_s_, kLeastRate),
          rate < kLeastRate ? "another program or a slow cable may keep it back" : ""};
}

std::vector<TestItem> HandTest::items() const {
  std::vector<TestItem> out = {readings()};
  // Shorter ones say little about a rate.
  if (moving_s_ > 0.2) out.push_back(rate());
  out.insert(out.end(), done_.begin(), done_.end());
  return out;
}

}  // namespace handrail
