#include "server/slave/robot_loop.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/base/units.h"
#include "server/follow/follow_gap.h"
#include "server/link/stall_watch.h"

namespace handrail {
namespace {

// How often the session is stepped while no controller paces it.
constexpr Nanos kIdlePeriod = 7 * kMillisecond;

// Why an arm that answers so cannot be driven, and by which joint; -1 where it can.
Status check_first(const FollowSettings& settings, const RobotReply& first, int& joint) {
  const auto degrees = [](double angle) { return fmt::format("{:.1f}", angle / kDeg); };
  for (const bool measured : {false, true}) {
    const JointVector& q = measured ? first.q_measured : first.q_commanded;
    const int i = joint = joint_out_of_range(settings, q);
    if (i < 0) continue;
    return Status::error(
        fmt::format("J{} is {} at {} deg, expected {} to {}: is this the arm, and "
                    "does it answer in radians?",
                    i + 1, measured ? "measured" : "commanded", degrees(q[i]),
                    degrees(settings.rated.lower[i]), degrees(settings.rated.upper[i])));
  }
  const JointVector off = (first.q_commanded - first.q_measured).cwiseAbs();
  Eigen::Index i = 0;
  if (off.maxCoeff(&i) <= settings.following.room) return Status::ok();
  joint = static_cast<int>(i);
  return Status::error(fmt::format(
      "J{} is commanded to {} deg but measured at {}, expected at most {:.2f} between them: is the "
      "arm at rest, and are its servos on?",
      i + 1, degrees(first.q_commanded[i]), degrees(first.q_measured[i]),
      settings.following.room / kDeg));
}

}  // namespace

RobotLoop::RobotLoop(Robot& robot, const FollowSettings& settings, SlaveMailboxes& boxes,
                     Nanos (*clock)() noexcept, SlaveTap* tap, StopCircuit* stop)
    : robot_(robot),
      settings_(settings),
      boxes_(boxes),
      clock_(clock),
      tap_(tap),
      stop_(stop),
      begins_(random_session_id()) {
  state_.fault_epoch = begins_;
}

Nanos RobotLoop::turn() {
  if (!connected_) return turn_unconnected();
  const RobotEvent event = robot_.wait(reply_);
  const Nanos now = clock_();
  switch (event) {
    case RobotEvent::kReply:
    case RobotEvent::kSilence:
      ++(event == RobotEvent::kReply ? cycles_ : silences_);
      input_.answer = reply_.prompt  ? Answer::kOnTime
                      : reply_.fresh ? Answer::kLate
                                     : Answer::kNone;
      take_reply();
      step(now, Reason::kNone);
      send();
      break;
    case RobotEvent::kRejected:
      if (output_.link.state != SessionState::kFault) output_.link.reason = Reason::kRobotBadPacket;
      break;
    case RobotEvent::kLost:
      connected_ = false;
      lost_ = true;
      input_.answer = Answer::kNone;
      step(now, Reason::kRobotLost);
      break;
  }
  publish();
  finish_when_standing(now);
  return 0;
}

Nanos RobotLoop::turn_unconnected() {
  const Nanos now = clock_();
  if (stop_requested_.load(std::memory_order_relaxed)) {
    finish();
    return 0;
  }
  // A reset of another fault meets this one.
  const bool in_fault = !lost_ && state_.session == SessionState::kFault;
  step(now, in_fault ? unconnected() : Reason::kNone);
  publish();
  // A reset calls a lost controller once. One that does not answer is lost anew.
  const bool again = lost_ && released(input_, state_);
  if (!again && (lost_ || now < next_attempt_)) return now + kIdlePeriod;
  connect();
  lost_ = again && !connected_;
  if (lost_) step(clock_(), refused_ < 0 ? Reason::kRobotLost : unconnected());
  return connected_ ? 0 : clock_() + kIdlePeriod;
}

void RobotLoop::send() noexcept {
  robot_.grip(output_.grip);
  if (output_.send == Send::kTarget) robot_.send(output_.q_target);
  if (output_.send == Send::kQuestion) robot_.ask();
}

void RobotLoop::take_reply() noexcept {
  input_.q_measured = reply_.q_measured;
  input_.q_commanded = reply_.q_commanded;
  input_.has_measured = reply_.has_measured;
  input_.has_commanded = reply_.has_commanded;
  input_.cycles = reply_.cycles;
  input_.anew = reply_.anew;
}

void RobotLoop::connect() {
  // Waiting for the controller is no stall: what was said stands meanwhile.
  publish(kConnectPatience);
  reply_.gripper = GripperState::kNone;  // the controller may be another one
  Status status = robot_.connect(kConnectPatience, reply_);
  refused_ = -1;
  if (status) {
    status = check_first(settings_, reply_, refused_);
    if (!status) robot_.end();
  }
  if (!status) {
    next_attempt_ = clock_() + kRetry;
    report_.problem = fixed_text<decltype(report_.problem)>(status.message());
    return publish();
  }
  report_.problem = {};
  connected_ = true;
  take_reply();
  input_.answer = Answer::kOnTime;
  place_ = reply_.q_commanded;
  step(clock_(), Reason::kNone);
  send();
  publish();
}

void RobotLoop::step(Nanos now, Reason fault) {
  input_.stop_input = stop_ != nullptr && stop_->is_open();
  take_settings();
  take_news(now);
  input_.unseen = stepped_at_ == -kForever ? 0 : now - stepped_at_;
  stepped_at_ = now;
  input_.robot_ready = connected_;
  input_.gripper = connected_ ? reply_.gripper : GripperState::kNone;
  input_.fault = fault;
  input_.shutdown = stop_requested_.load(std::memory_order_relaxed);
  // An image is of before the motion is placed.
  if (tap_ != nullptr) keep_image(now);
  if (place_) place(settings_, *place_, state_);
  follow_step(settings_, input_, state_, output_);
  if (tap_ != nullptr) keep_cycle(now);
  place_.reset();
}

void RobotLoop::take_news(Nanos now) {
  if (boxes_.master.take(news_)) {
    input_.master = news_.state;
    input_.master_known = true;
  }
  input_.master_age = news_.link.age(now);
  input_.master_sequence = news_.link.sequence;
  input_.link = news_.link.view(now);
  (void)boxes_.force.take(force_);
  input_.f_E_T = force_.f_E_T;
  const bool fresh = now - force_.received_at <= kForceFresh;
  input_.wrench_valid = fresh && force_.healthy;
  input_.wrench_overrange = fresh && force_.overrange;
}

// Another scene takes effect only while the arm stands and follows nobody.
void RobotLoop::take_settings() {
  settings_wait_ = boxes_.settings.take(next_settings_) || settings_wait_;
  const bool idle = state_.session == SessionState::kOff || state_.session == SessionState::kFault;
  const bool stands = place_ || standing(state_.motion);
  if (!settings_wait_ || !idle || !stands) return;
  settings_ = next_settings_;
  settings_wait_ = false;
  if (state_.placed && !place_) place_ = state_.motion.joints.q;
}

void RobotLoop::keep_image(Nanos now) noexcept {
  tap_->image_before(++kept_.number, now, settings_.number, begins_,
                     [this](auto& bytes) { return save_follow(state_, output_, bytes); });
}

void RobotLoop::keep_cycle(Nanos now) noexcept {
  kept_.at = now;
  kept_.scene = settings_.number;
  kept_.placed = place_.has_value();
  kept_.place = place_.value_or(JointVector::Zero());
  kept_.given = input_;
  kept_.timing = {news_.link.received_at, news_.link.peer_sent, news_.link.round_trip};
  kept_.came = output_;
  tap_->keep(kept_);
}

Reason RobotLoop::unconnected() const noexcept {
  return refused_ < 0 ? Reason::kRobotNotConnected : Reason::kEncoderInvalid;
}

void RobotLoop::publish(Nanos busy_for) {
  if (refused_ >= 0) {
    output_.link.obstacle = unconnected();
    if (output_.link.state != SessionState::kFault) output_.link.reason = unconnected();
    output_.link.ledger.joint = static_cast<std::int8_t>(refused_);
    output_.link.q_measured = reply_.q_measured;
  }
  // A reset meets that again.
  if (!connected_ && output_.link.state == SessionState::kFault) {
    output_.link.obstacle = lost_ ? Reason::kRobotLost : unconnected();
  }
  output_.link.cycles = cycles_;
  output_.link.silences = silences_;
  const bool another_stop = report_.state.stop_epoch != output_.link.stop_epoch;
  report_.state = output_.link;
  report_.halts = state_.halts;
  report_.connected = connected_;
  report_.lost = lost_;
  report_.good_until = clock_() + kStateStands + busy_for;
  boxes_.report.publish(report_);
  if (another_stop) boxes_.doorbell.ring();
}

void RobotLoop::finish_when_standing(Nanos now) {
  if (!stop_requested_.load(std::memory_order_relaxed)) return;
  if (stop_since_ < 0) stop_since_ = now;
  if (input_.shutdown && standing(state_.motion)) return finish();
  if (now - stop_since_ > kStopPatience) finish();
}

void RobotLoop::finish() {
  robot_.end();
  connected_ = false;
  finished_.store(true, std::memory_order_release);
}

}  // namespace handrail
