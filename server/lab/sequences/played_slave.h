// A slave that engages when it is asked to, and whose arm is where it is told to be.
#pragma once

#include "server/base/spatial.h"
#include "server/model/link_state.h"

namespace handrail {

// Off, with the tip at `X_ST`.
inline SlaveState played_slave(const Pose& X_ST) {
  SlaveState out;
  out.X_ST = out.X_ST_command = X_ST;
  out.has_pose = true;
  return out;
}

// What it says to what the master said last.
inline void play_slave(const MasterState& said, SlaveState& slave) {
  slave.scene = said.scene;
  slave.hashes = said.hashes;
  slave.engagement_epoch = said.engagement_epoch;
  slave.state = said.state == SessionState::kAligning || said.state == SessionState::kEngaged
                    ? SessionState::kEngaged
                    : SessionState::kOff;
  if (said.state == SessionState::kEngaged) slave.X_ST = slave.X_ST_command = said.X_SU;
}

}  // namespace handrail
