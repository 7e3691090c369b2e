// Where the slave's two threads meet: newest values, nobody waits.
#pragma once

#include "server/base/doorbell.h"
#include "server/base/fixed_text.h"
#include "server/base/mailbox.h"
#include "server/follow/follow_step.h"
#include "server/link/peer.h"
#include "server/model/link_state.h"

namespace handrail {

// The master's newest state and how it came.
struct MasterNews {
  MasterState state;
  LinkSnapshot link;
};

// One record of the force sensor.
struct ForceReading {
  Wrench f_E_T;            // [N], [N m], axes of the tip frame
  bool healthy = false;    // the sensor reports no fault
  bool overrange = false;  // it reports that an axis is beyond its range
  Nanos received_at = -kForever;
};

// What the robot loop says to the master.
struct SlaveReport {
  SlaveState state;
  Nanos good_until = kForever;  // later it is no longer true: the loop stands still
  std::uint64_t halts = 0;      // of an arm in motion, since the controller was not heard
  bool connected = false;       // to the controller
  bool lost = false;            // it was, and is called again only after a reset
  FixedText<240> problem{};     // why not; empty: it has not been tried, or is connected
};

struct SlaveMailboxes {
  Mailbox<MasterNews> master;        // IO to robot
  Mailbox<ForceReading> force;       // IO to robot
  Mailbox<FollowSettings> settings;  // IO to robot: another scene
  Mailbox<SlaveReport> report;       // robot to IO
  Doorbell doorbell;                 // robot to IO: the report tells of another stop
};

}  // namespace handrail
