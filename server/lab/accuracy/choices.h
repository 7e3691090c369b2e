// The choices besides the walls, each against time. Rows are in no unit but those they name.
#pragma once

#include <atomic>

#include "server/lab/scenes/row.h"

namespace handrail {

// Algorithm 2 in steps of 1 to 0.001 mm, and the closed form. Error: the proxy on a line and on a
// plane, from the closed form's, the hand at up to 0.25 m/s [um]. Cost: one update [ns].
AccuracyRows tool_rows(const std::atomic<bool>& cancelled);

// Mean of the last 1 to 1000 samples at 1 kHz. Error: what is left of the simulated hand's tremor
// [um]. Cost: lag of the command behind a reach of 80 mm in 1 s [ms]; p999 is near its ends.
AccuracyRows smoother_rows();

// Schemes and steps on the simulated hand, 0.12 kg, pushed against 60 N/mm from 3 mm away by 2 N.
// Error: position, from the exact solution [um]. Cost: 1 ms of simulated time [ns]. "hand model" is
// the scheme of the simulated hand as it ships.
AccuracyRows integrator_rows(const std::atomic<bool>& cancelled);

// The wall step at 250 Hz to 10 kHz under a hand of 1.3 kg that meets 5 N/mm at about 0.15 m/s.
// Error: the wall's force on the hand, from that of a continuous wall [N]; the note has the
// penetration's. Cost: time of the step in each second of the loop [us/s].
AccuracyRows rate_rows(const std::atomic<bool>& cancelled);

// Datagrams at 25 to 2000 Hz. Error: the command the slave holds at its cycles (7.1 ms), from the
// master's at that moment, the tip going 75 mm in 1.8 s [um]. Cost: encoding and decoding in each
// second [us/s].
AccuracyRows link_rows(const std::atomic<bool>& cancelled);

}  // namespace handrail
