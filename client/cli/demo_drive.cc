#include "client/cli/demo_drive.h"

#include <poll.h>

#include <array>
#include <cstdio>

#include "client/cli/status_view.h"
#include "server/base/clock.h"
#include "server/base/units.h"
#include "server/model/reason.h"

namespace handrail {
namespace {

constexpr double kMoveTime = 2.5;  // of one hand move [s]
constexpr Nanos kSettle = 800 * kMillisecond;
constexpr double kFollows = 5.0 * kMm;  // an arm further behind a hand at rest is held
constexpr Nanos kSample = 7 * kMillisecond;
constexpr Nanos kDrivePatience = 5 * kSecond;
constexpr Nanos kMovePatience = 20 * kSecond;
// Both sides have to hear each other well for a second before they engage.
constexpr Nanos kDriveEngages = 20 * kSecond;
constexpr Nanos kAgain = 300 * kMillisecond;
// Where the hand leads the arm back to a place: what the demo itself can have left, and a little.
constexpr double kFarthestBack = 150.0 * kMm, kWidestBack = 90.0 * kDeg;
constexpr int kMostLosses = 10;  // in one move
constexpr double kThere = 1.0 * kMm, kThereTurned = 1.0 * kDeg;
constexpr int kLeads = 4;  // moves of the hand, which strays by a millimetre
// Farther off than this it is not the hand's straying (drift_rms_mm of 0.97 mm and drift_rms_deg of
// 0.7 deg, twice that at the arm, and seven times that): something keeps the arm away.
constexpr double kNear = 15.0 * kMm, kNearTurned = 10.0 * kDeg;

bool drives(const pb::Status& s) { return s.state() == "engaged" || s.state() == "hold"; }

bool stopped(const pb::Status& s) {
  for (const Reason reason : {Reason::kStopRequested, Reason::kStopInput}) {
    if (s.reason() == describe(reason) || s.slave_reason() == describe(reason)) return true;
  }
  return false;
}

template <typename Set>
pb::Request with(Set set) {
  pb::Request request;
  set(request);
  return request;
}

// Device right is -Y at the robot, up is +Z, toward the user is -X.
Vec3 to_device(const Vec3& v_S) { return Vec3(-v_S.y(), v_S.z(), -v_S.x()); }

}  // namespace

void DemoDriver::fail(const std::string& problem, ExitCode code) {
  if (code_ != kExitDone) return;
  code_ = code;
  problem_ = problem;
}

void DemoDriver::lose(const pb::Status& status) {
  if (stopped(status)) return fail("the arm was stopped: " + why_text(status.ledger()));
  why_lost_ = status.ledger().sentence();
  ++losses_;
  if (++losses_of_move_ > kMostLosses)
    return fail("the session ended again and again: " + why_lost_);
  lost_ = true;
}

Result<pb::Reply> DemoDriver::call(const pb::Request& request, Nanos patience) {
  Result<pb::Reply> reply = client_.call(request, patience);
  if (interrupted()) fail("interrupted", kExitInterrupted);
  if (!reply) fail(reply.message(), exit_code(reply));
  return reply;
}

pb::Status DemoDriver::status() {
  if (code_ != kExitDone) return {};
  const Nanos asked = monotonic_now();
  const Result<pb::Reply> reply = call(with([](pb::Request& r) { r.set_status(true); }));
  machine_.waited(asked, monotonic_now());  // it is answered at once
  return reply ? reply->status() : pb::Status();
}

bool DemoDriver::order(const pb::Request& request) {
  if (!ok()) return false;
  const Result<pb::Reply> reply = call(request);
  if (!reply) return false;
  if (reply->done()) return true;
  const pb::Status now = status();
  if (ok() && drives(now)) fail("refused: " + reply->reason(), exit_code(reply));
  if (ok()) lose(now);
  return false;
}

bool DemoDriver::wait() {
  const Nanos due = monotonic_now() + kSample;
  ::poll(nullptr, 0, static_cast<int>(kSample / kMillisecond));
  machine_.waited(due, monotonic_now());
  if (interrupted()) fail("interrupted", kExitInterrupted);
  return code_ == kExitDone;
}

bool DemoDriver::move(const Vec3& by_mm, const Vec3& turn_deg,
                      const std::function<void(const pb::Status&)>& see) {
  pb::Request request;
  pb::HandMove& hand = *request.mutable_hand();
  hand.mutable_displacement_mm()->Add(by_mm.begin(), by_mm.end());
  hand.mutable_rotation_deg()->Add(turn_deg.begin(), turn_deg.end());
  hand.set_duration_s(kMoveTime);
  if (!order(request)) return false;
  Nanos still_since = -1;
  const Nanos give_up = monotonic_now() + kMovePatience;
  while (wait()) {
    const pb::Status now = status();
    if (!ok()) return false;
    if (!drives(now)) {
      lose(now);
      return false;
    }
    if (see) see(now);
    const Nanos t = monotonic_now();
    if (now.hand_moving()) {
      still_since = -1;
    } else if (still_since < 0) {
      still_since = t;
    } else if (t - still_since > kSettle) {
      const double behind = (pose_of(now.command()).p - pose_of(now.tip()).p).norm();
      if (behind > kFollows) fail("the arm could not follow: " + why_text(now.ledger()));
      return ok();
    }
    if (t > give_up) fail("the simulated hand did not come to rest");
  }
  return false;
}

bool DemoDriver::engage() {
  const Nanos give_up = monotonic_now() + kDriveEngages;
  std::string refused = "the master does not engage";
  while (code_ == kExitDone && monotonic_now() < give_up) {
    pb::Status now = status();
    if (code_ != kExitDone) return false;
    if (now.state() == "engaged") {
      lost_ = false;
      return true;
    }
    if (stopped(now)) {
      fail("the arm was stopped: " + why_text(now.ledger()));
      return false;
    }
    // Each of these may be refused for now: the next round sees what has come of it.
    // A slave that was paused may come to its fault after the master's has been reset.
    if (now.state() == "fault" || now.slave_state() == "fault") {
      (void)call(with([](pb::Request& r) { r.set_reset(true); }));
    }
    const Result<pb::Reply> home =
        call(with([](pb::Request& r) { r.mutable_hand()->set_home(true); }));
    if (home && !home->done()) fail("refused: " + home->reason());
    for (now = status(); code_ == kExitDone && now.hand_moving(); now = status()) {
      if (!wait()) return false;
    }
    const Result<pb::Reply> engaged = call(with([](pb::Request& r) { r.set_engage(true); }),
                                           give_up - monotonic_now() + kDrivePatience);
    if (engaged && !engaged->done()) refused = "refused: " + engaged->reason();
    for (Nanos until = monotonic_now() + kAgain; monotonic_now() < until;) {
      if (!wait()) return false;
      if (engaged && engaged->done()) break;
    }
  }
  fail(refused);
  return false;
}

bool DemoDriver::lead(const Pose& X_S) {
  const pb::Status now = status();
  const Twist way = between(pose_of(now.command()), X_S);
  return ok() && move(to_device(way.linear) / kDemoScale / kMm, to_device(way.angular) / kDeg);
}

bool DemoDriver::drive_to(const Pose& X_S) {
  for (int i = 0; ok(); ++i) {
    const Pose X = pose_of(status().command());
    const Twist way = between(X, X_S);
    const double far = way.linear.norm(), turned = way.angular.norm();
    if (!ok() || (far < kThere && turned < kThereTurned)) break;
    if (i < kLeads && far < kFarthestBack && turned < kWidestBack) {
      lead(X_S);
      continue;
    }
    std::array<char, 240> text{};
    if (i == kLeads) {
      if (far < kNear && turned < kNearTurned) break;  // as near as this hand gets
      std::snprintf(text.data(), text.size(),
                    "the hand led the arm %d times and it still stands %.0f mm and %.0f deg from "
                    "(%.0f, %.0f, %.0f) mm; expected at most %.0f mm and %.0f deg: ",
                    kLeads, far / kMm, turned / kDeg, X_S.p.x() / kMm, X_S.p.y() / kMm,
                    X_S.p.z() / kMm, kNear / kMm, kNearTurned / kDeg);
      fail(text.data() + why_text(status().ledger()));
      break;
    }
    std::snprintf(text.data(), text.size(),
                  "the arm stands %.0f mm and %.0f deg from where this begins, (%.0f, %.0f, %.0f) "
                  "mm; expected at most %.0f mm and %.0f deg: drive it there, or restart the rig",
                  far / kMm, turned / kDeg, X_S.p.x() / kMm, X_S.p.y() / kMm, X_S.p.z() / kMm,
                  kFarthestBack / kMm, kWidestBack / kDeg);
    fail(text.data());
  }
  return ok();
}

bool DemoDriver::recover(const Pose& X_S, const Say& say) {
  while (lost()) {
    say("the session ended: " + why_lost_ + "; resetting, engaging, repeating this move");
    if (!engage()) return false;
    order(with([](pb::Request& r) { r.mutable_tool_off(); }));
    drive_to(X_S);
  }
  return ok();
}

}  // namespace handrail
