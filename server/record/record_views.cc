#include "server/record/record_views.h"

#include <algorithm>

namespace handrail {
namespace {

constexpr Nanos kPicture = 10 * kMillisecond;
constexpr char kFrame[] = "base";  // as the console's viewers have it

template <typename Time>
void put_time(Nanos calendar, Time& out) {
  out.set_seconds(calendar / kSecond);
  out.set_nanos(static_cast<std::int32_t>(calendar % kSecond));
}

}  // namespace

bool RecordViews::due(Nanos at) {
  if (at < next_) return false;
  next_ = std::max(next_ + kPicture, at);
  return true;
}

void RecordViews::see(const KeptTick& tick, RecordSink& sink) {
  const MasterState& led = tick.came.out.link;
  say(led.state, tick.came.out.reason, tick.at, sink);
  if (!due(tick.at)) return;
  if (tick.given.in.slave_known) show_arm(tick.given.in.slave, tick.at, sink);
  if (led.has_command) show_pose(RecordChannel::kDesired, led.X_SU, tick.at, sink);
}

void RecordViews::see(const KeptCycle& cycle, RecordSink& sink) {
  const SlaveState& arm = cycle.came.link;
  say(arm.state, arm.state == SessionState::kFault ? arm.fault : arm.reason, cycle.at, sink);
  if (due(cycle.at)) show_arm(arm, cycle.at, sink);
}

void RecordViews::show_arm(const SlaveState& arm, Nanos at, RecordSink& sink) {
  if (!arm.has_pose) return;
  foxglove::JointStates out;
  put_time(sink.calendar(at), *out.mutable_timestamp());
  for (int i = 0; i < kJoints; ++i) {
    foxglove::JointState& joint = *out.add_joints();
    joint.set_name("J" + std::to_string(i + 1));
    joint.set_position(arm.q_measured[i]);
  }
  out.SerializeToString(&bytes_);
  sink.message(RecordChannel::kJointStates, at, bytes_);
  show_pose(RecordChannel::kTip, arm.X_ST, at, sink);
}

void RecordViews::show_pose(RecordChannel channel, const Pose& X_S, Nanos at, RecordSink& sink) {
  foxglove::PoseInFrame out;
  put_time(sink.calendar(at), *out.mutable_timestamp());
  out.set_frame_id(kFrame);
  foxglove::Vector3& p = *out.mutable_pose()->mutable_position();
  p.set_x(X_S.p.x());
  p.set_y(X_S.p.y());
  p.set_z(X_S.p.z());
  foxglove::Quaternion& q = *out.mutable_pose()->mutable_orientation();
  q.set_x(X_S.q.x());
  q.set_y(X_S.q.y());
  q.set_z(X_S.q.z());
  q.set_w(X_S.q.w());
  out.SerializeToString(&bytes_);
  sink.message(channel, at, bytes_);
}

void RecordViews::say(SessionState state, Reason reason, Nanos at, RecordSink& sink) {
  if (said_ && state == state_ && reason == reason_) return;
  said_ = true;
  state_ = state;
  reason_ = reason;
  foxglove::Log line;
  put_time(sink.calendar(at), *line.mutable_timestamp());
  const bool fault = state == SessionState::kFault;
  line.set_level(fault                     ? foxglove::Log::ERROR
                 : reason != Reason::kNone ? foxglove::Log::WARNING
                                           : foxglove::Log::INFO);
  line.set_name(program_);
  line.set_message(std::string(name_of(state)) +
                   (reason == Reason::kNone ? "" : std::string(": ") + describe(reason)));
  line.SerializeToString(&bytes_);
  sink.message(RecordChannel::kLog, at, bytes_);
}

}  // namespace handrail
