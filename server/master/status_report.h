// The master's status as operators see it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "proto/operator.pb.h"
#include "server/kinematics/rv2a.h"
#include "server/link/transport.h"
#include "server/master/mailboxes.h"

namespace handrail {

// What stays the same while the master runs.
struct MasterIdentity {
  std::string device;
  bool device_simulated = false;
  std::string realtime;  // what the haptic thread got
  RealtimeGrants grants = {};
  std::string slave_at = {};  // where a slave is looked for
  Nanos loop_warn = 0;        // an older loop is said
  Nanos loop_limit = 0;       // an older one takes the force away
  // Lines of the log that were lost so far; empty: nobody counts.
  std::function<std::uint64_t()> log_lost = {};
  // Who is at the other end of the link; empty: nobody knows.
  std::function<LinkIdentity(Nanos now)> link = {};
  // Of the device.
  Vec3 workspace_half = Vec3::Zero();  // [m]
  double max_force = 0.0;              // [N]
  bool device_turns = false;           // it says how the hand is turned
  bool led_by_cursor = false;
  // Of the sensor on its handle; empty: there is none.
  std::string handle_sensor = {};
  bool handle_simulated = false;
};

// Everything `handrail status` shows, at `now`. Without news from the slave its fields are "none".
pb::Status status_report(const MasterIdentity& identity, const HapticReport& report,
                         const SlaveState& slave, const LinkSnapshot& link, Nanos now);

// The joints that go with the slave's poses, for the scene's arm. Of a slave that is not heard, or
// whose command has no joints on the branch that the arm is on: not those.
void show_joints(const ArmGeometry& arm, const SlaveState& slave, pb::Status& status);

// What the loop says of the walls; the scene's names are others' to add.
void show_walls(const WallReport& walls, pb::WallStatus& status);

// `reason` in words; of a slave in fault also why it is, and of a device what it says of itself.
std::string reason_text(Reason reason, const HapticReport& report);

// "the slave is led by another master (process 4711 on this computer, for 12 s)". Only of a link
// that is refused at `now`.
std::string other_master_text(const LinkSnapshot& link, Nanos now);

// kLinkQuality with what was measured and what is asked: "the link is not good enough: 60.3 % lost
// on the way to the slave, at most 25 % in 1 s is asked". Of a bad moment alone: as it is `now`.
std::string link_quality_text(const HapticOutput& out, const LinkSnapshot& link, Nanos now);

// Each section both sides must agree on and do not: "mapping: master 3f2a..., slave 91bc...".
std::vector<std::string> hash_mismatches(const MasterState& master, const SlaveState& slave);

}  // namespace handrail
