// A surface touched twice across the link by a passive hand that is kicked wherever it is to be
// still.
#pragma once

#include <string>

#include "server/lab/network/link_faults.h"
#include "server/lab/stability/stability_case.h"

namespace handrail {

// SI.
struct TeleopCell {
  double round_trip = 0.0;  // half of it each way [s]
  LinkFaults faults;        // each way, without the delay
  // It engages over the delay alone, and gets the faults afterwards.
  bool later = false;
  double grip = 250.0;      // of the hand [N/m]
  double stiffness = 50e3;  // of the surface; the arm's 60 N/mm are in series; 0: nothing is there
  bool local = false;       // the surface is rendered at the master
};

// What a cell came to.
struct TeleopFigures {
  std::string refused;      // why it does not engage, or the link ended it; empty: neither
  std::string ended;        // why the engagement ended otherwise; empty: it did not
  double hand_swing = 0.0;  // of the last second of each of the four rests, most [m]
  double tip_swing = 0.0;   // [m]
  double energy = 0.0;      // that the hand was given in a touch, beyond what the device took [J]
  double bounds = 0.0;      // of force and command, largest share
  double most_step = 0.0;   // of the force between two ticks [N]
  double inward = 0.0;  // largest step of the command into the surface when it had been above the
                        // threshold for as long as the arm takes to stop [m]
  double peak = 0.0;    // contact force, as a share of what the bumper lets a peak come to
  double drift = 0.0;   // of the tip from where the hand asks it to be, after a touch, most [m]
  double held = 0.0;    // share of ticks in a hold
  double felt = 0.0;    // at the second touch, force per depth in its first second more than two
                        // counts of the encoder inside [N/m]; 0: there was none
  double error = 0.0;   // of the force at the second touch against the true surface, rms [N]

  bool stable() const;
};

// Same cell and seed, same figures. The hand goes 8 mm past the surface, or as far in free space,
// in 1.5 s, is kicked at it by half a metre a second, stays, goes back, is kicked out and stays;
// twice.
TeleopFigures measure_teleop(const TeleopCell& cell, std::uint64_t seed);

// As figures of a case:
//
//   hand_swing_mm, tip_swing_mm in the last second of a rest: at most two of the encoder's counts
//   energy_mj     given in a touch, from its start on, beyond what the device took by itself;
//                 with a local model in the second touch, for the first brings it while the
//                 hand is inside
//   bounds        of what the steps of force and command may be (server/lab/sequences/bounds.h)
//   inward_um     of the command into the surface while more than the bumper's threshold is
//                 measured, from when the arm can have stopped: at most the finest step there is
//   peak_share    of f_th + k v (D + 2.5 T), which is what a bumper's peak may come to
//   drift_mm      of the tip from where the hand asks it to be, after a touch
//   ended         the engagement ended, though not for the link
CaseOutcome run_teleop_cell(const TeleopCell& cell, std::uint64_t seed);

}  // namespace handrail
