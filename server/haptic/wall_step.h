// One tick of a two-axis scene: hand among the walls in, force of walls and effects out.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "server/constraint/wall_proxy.h"
#include "server/effects/effect_stack.h"
#include "server/haptic/arbiter.h"
#include "server/haptic/hand_reading.h"
#include "server/haptic/ledger.h"
#include "server/haptic/stage_watch.h"
#include "server/model/reason_set.h"
#include "server/stability/energy_governor.h"

namespace handrail {

// Constant while a scene is loaded.
struct WallSettings {
  std::shared_ptr<const Walls> walls;  // never null in a step
  ForceLimits force;                   // of the device; `step` bounds what no motion explains
  DeviceEffects device;                // what a simulated device shows meanwhile
  GovernorSettings governor;           // of the energy at the hand; off unless set
  double share = 1.0;  // of walls and effects that is rendered: what the device holds
};

struct WallInput {
  HandReading hand;
  Nanos unseen = 0;                // as HapticInput's [ns]
  int stage = 0;                   // of Walls::stages, as ordered; outside them: the nearest
  std::uint32_t stage_orders = 0;  // counts the orders: one for the same stage is one, too
  bool release = false;            // the force goes, as after a stop
  double screw_c = -1.0;           // of progressive friction [N s/(m rad)]; below 0: the scene's
};

struct WallOutput {
  Wrench f_H_M;              // for the device, within its limits, always finite; in M's X and Y
  Vec2 hand = Vec2::Zero();  // frame of the walls, last valid [m]
  WallContact contact;       // frame of the walls
  EffectTick effects;        // before the limits, frame of the walls
  ForceShares shares;        // `tool` is what walls and effects got
  ForceLedger ledger;        // the same, stage by stage
  double energy_made = 0.0;  // at the hand, that the governor has yet to take back, >= 0 [J]
  ReasonSet reasons;         // every intervention of this tick
  int stage = 0;             // in force
};

// What a step remembers, but for the proxy. `effects` are the scene's, put here before the first
// step.
struct WallMemory {
  EffectStack effects;
  EnergyGovernor governor;
  Arbiter arbiter;
  StageWatch stages;
  Pose2 pose;                                          // of the walls in M
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();  // of the walls in M
  Vec2 hand = Vec2::Zero();                            // last valid, in M [m]
  Vec2 velocity = Vec2::Zero();                        // [m/s]
  double wall_stiffness = 0.0;                         // of the wall last touched [N/m]
  bool started = false;                                // the proxy follows the hand
  HandGap gap;

  // The force is gone at once: the device does not say where the hand is, or has let go.
  void cut() noexcept {
    arbiter.cut();
    governor.restart();
  }
};

struct WallWay {
  std::unique_ptr<WallProxy> proxy;  // the scene's, put here before the first step
};

// The memory comes last: whatever came after it might stand in the space at its end that aligns it,
// and would go along when all of its bytes are kept or brought back.
struct WallState : WallWay, WallMemory {};

// Everything a running scene of walls is. May be large.
struct WallRun {
  WallSettings settings;
  WallState state;
};

// Pure and bounded: no clock, lock, log or allocation. `dt` > 0 [s].
//
// The governor keeps what walls and effects ask for from making energy, before the limits.
//
// The stage in force is the one ordered last, or one whose condition has become true since.
//
// The hand's X and Y in M are taken to the walls' frame of the stage; there the proxy advances, the
// effects give their force, and it goes back to M through the limits of the device. Whatever makes
// the force jump (walls that come, move, turn or harden with a stage, a region's edge), it changes
// by at most `force.step` a millisecond beside what the hand's motion over the springs explains. A
// reading that is invalid or no place (not finite, beyond 10 m or 100 m/s) cuts the force for its
// tick and moves nothing; after 20 ms of them the proxy starts anew where the hand comes back.
void wall_step(const WallSettings& settings, const WallInput& in, double dt, WallState& state,
               WallOutput& out) noexcept;

}  // namespace handrail
