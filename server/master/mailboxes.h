// Where the master's two threads meet: newest values and short queues, nobody waits.
#pragma once

#include <atomic>

#include "devices/haptic_device.h"
#include "server/base/doorbell.h"
#include "server/base/mailbox.h"
#include "server/base/ring.h"
#include "server/constraint/wall_proxy.h"
#include "server/haptic/haptic_run.h"
#include "server/link/peer.h"
#include "server/model/handle_force.h"

namespace handrail {

// The slave's newest state and how it came.
struct SlaveNews {
  SlaveState state;
  LinkSnapshot link;
};

// An order on its way to the haptic loop. `hand` is for the simulated hand, if `is_hand`.
struct OrderTicket {
  std::uint64_t id = 0;
  HapticOrder order;
  bool is_hand = false;
  HandIntent hand;
};

struct OrderAnswer {
  std::uint64_t id = 0;
  Reason result = Reason::kNone;
  double tool_distance = 0.0;  // as in HapticOutput
  double hand_latched = 0.0;   // as in HapticOutput
  double tool_angle = 0.0;     // as in HapticOutput
  std::uint32_t tool_id = 0;   // as in HapticOutput
};

// The hand among the walls of the scene, frame of the walls.
struct WallReport {
  bool present = false;  // the scene has walls
  int stage = 0;
  WallContact contact;
  Vec2 hand = Vec2::Zero();   // [m]
  Vec2 force = Vec2::Zero();  // on the hand, as the device was told [N]
  double penetration = 0.0;   // of the hand beyond the proxy [m]
  bool locked = false;        // a detent holds the hand
  int place = -1;             // which of its places does; -1: none
  bool has_screw = false;     // something progressive is turned
  double turned = 0.0;        // in all [rad]
  double screw_c = 0.0;       // of (2.2) [N s/(m rad)]
};

// What the haptic loop tells about itself after every tick.
struct HapticReport {
  HapticOutput out;
  Pose X_MH;
  WallReport walls;
  HandleForce handle;
  // Why the newest reading of the device is not valid; empty: it is, or the device does not say.
  DeviceTrouble trouble{};
  bool hand_moving = false;
  bool scene_pending = false;     // a scene waits for the session to be off
  std::uint64_t scene_epoch = 0;  // scenes taken over so far
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;
  // Lateness of the ticks so far [ns], renewed a few times a second.
  Nanos late_p50 = 0;
  Nanos late_p99 = 0;
  Nanos late_p999 = 0;
  Nanos late_max = 0;
  Nanos sent_until = kForever;  // later the slave is no longer told
  Nanos good_until = kForever;  // later it is no longer true: the loop stands still
};

struct MasterMailboxes {
  Mailbox<SlaveNews> slave;                  // IO to haptic
  Mailbox<LoopScene> scene;                  // IO to haptic: another one
  Ring<OrderTicket, 64> orders;              // IO to haptic
  Mailbox<CursorSample> cursor;              // IO to haptic: of a device that one leads
  Ring<OrderAnswer, 64> answers;             // haptic to IO
  Mailbox<HandleReading> handle;             // IO to haptic: of the sensor on the handle
  std::atomic<Nanos> hold_heard{-kForever};  // IO to haptic: newest sign of `engage --hold`
  Mailbox<HapticReport> report;              // haptic to IO
  Doorbell doorbell;                         // haptic to IO: an order was answered
};

}  // namespace handrail
