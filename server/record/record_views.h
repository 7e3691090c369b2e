// What Foxglove and Lichtblick draw of a recording: joints, poses and the reasons as a log.
#pragma once

#include <string>

#include "proto/foxglove.pb.h"
#include "server/model/reason.h"
#include "server/record/record_sink.h"
#include "server/record/record_tap.h"

namespace handrail {

// A hundred pictures a second, and a line whenever the reason changes. For one thread; may
// allocate.
class RecordViews {
 public:
  explicit RecordViews(std::string program) : program_(std::move(program)) {}

  // Of the master: the arm as the slave says, and where the hand leads it.
  void see(const KeptTick& tick, RecordSink& sink);
  // Of the slave.
  void see(const KeptCycle& cycle, RecordSink& sink);

 private:
  void show_arm(const SlaveState& arm, Nanos at, RecordSink& sink);
  void show_pose(RecordChannel channel, const Pose& X_S, Nanos at, RecordSink& sink);
  void say(SessionState state, Reason reason, Nanos at, RecordSink& sink);
  bool due(Nanos at);

  const std::string program_;
  Nanos next_ = -kForever;
  bool said_ = false;
  SessionState state_ = SessionState::kOff;
  Reason reason_ = Reason::kNone;
  std::string bytes_;
};

}  // namespace handrail
