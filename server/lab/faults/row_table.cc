// The fault matrix: one entry a row.
#include "server/lab/faults/fault_rows.h"

namespace handrail {
namespace {

// id, what, unit, runs, quick runs, function.
constexpr FaultRow kRows[] = {
    {"N1a", "10 % loss each way for 10 minutes: no trip", "ms gap", 1, 1, rows::n1a},
    {"N1b", "30 % loss each way for 10 minutes: nothing latches", "ms gap", 1, 1, rows::n1b},
    {"N1c", "up to 10 % loss: the arm follows as well", "of the clean error", 3, 3, rows::n1c},
    {"N1d", "40 % loss is not engaged over, 75 % holds", "ms engaged", 8, 2, rows::n1d},
    {"N2", "bursts of loss of 2 to 200 ms: every stop in its bound", "ms to stop", 20, 5, rows::n2},
    {"N3", "delays up to 500 ms one way: drivable, their age shown", "% off the loop age", 6, 6,
     rows::n3},
    {"N4", "jitter up to 50 ms on 50 ms: jerk within its limit", "of the jerk limit", 8, 8,
     rows::n4},
    {"N5", "reordering: nothing stale applied", "stale applied", 6, 3, rows::n5},
    {"N6", "duplicates and a million replays: nothing applied twice", "stale applied", 4, 4,
     rows::n6},
    {"N9", "blackouts of 10 ms to 60 s", "ms to stop", 20, 5, rows::n9},
    {"N10a", "nothing reaches the slave", "ms to stop", 40, 4, rows::n10a},
    {"N10b", "nothing reaches the master: its force goes", "ms to no force", 20, 2, rows::n10b},
    {"N11", "64 kbit/s to 2 Mbit/s, a queue of a second: old loops fade", "ms to fade", 4, 4,
     rows::n11},
    {"N13", "delay, jitter, loss and duplicates for half an hour", "ms to stop", 2, 2, rows::n13},
    {"P1", "master stopped for 5 ms to 10 s or killed, a late burst", "ms to stop", 36, 6,
     rows::p1},
    {"P5", "haptic thread stalled for 50 ms or for good", "ms to stop", 20, 2, rows::p5},
    {"P8", "a minute of stops, resets, faults and restarts", "ms to stop", 12, 2, rows::p8},
    {"C2", "clocks 5000 s apart: the same bits", "ms to stop", 4, 2, rows::c2},
    {"S1a", "NaN, Inf, 1e308 or a denormal from the force sensor", "ms to stop", 16, 8, rows::s1a},
    {"S1b", "NaN, Inf, 1e308 or a denormal from an encoder", "ms to stop", 24, 8, rows::s1b},
    {"S1c", "NaN, Inf, 1e308 or a denormal from the haptic device", "N", 16, 8, rows::s1c},
    {"S2a", "the force sensor repeats itself: found in 100 ms", "ms to stop", 20, 2, rows::s2a},
    {"S2b", "a clean hour: no false alarm", "false alarms", 1, 1, rows::s2b},
    {"S3a", "spike, drift, scale and exchanged axes of the sensor", "mm away", 12, 4, rows::s3a},
    {"S3b", "a saturated axis of the sensor", "ms to stop", 6, 3, rows::s3b},
    {"S4", "local stop circuit pressed, bouncing, open", "ms to stop", 9, 3, rows::s4},
    {"S5", "a servo follows late, stops following, runs away", "ms to stop", 9, 3, rows::s5},
    {"S6", "nobody holds the device's button: at rest in half a second", "um after it", 10, 2,
     rows::s6},
    {"N3c", "in contact: delays up to 500 ms one way: no swing", "N", 6, 6, rows::n3c},
    {"P1c", "in contact: master stopped or killed, a late burst", "N", 12, 6, rows::p1c},
    {"S1d", "in contact: NaN, Inf, 1e308 from the force sensor", "N", 12, 6, rows::s1d},
    {"S2c", "in contact: the force sensor repeats itself", "N", 9, 3, rows::s2c},
    {"S3c", "in contact: wrong sign: found in 200 ms", "ms to stop", 8, 2, rows::s3c},
    {"S3d", "in contact: saturation, drift, scale, spike", "N", 12, 4, rows::s3d},
    {"S3e", "in contact: exchanged axes: found 0.2 s after 80 N", "ms to stop", 8, 2, rows::s3e},
    {"S1e", "glitches of an encoder, then a contact", "N", 12, 3, rows::s1e},
    {"S1f", "an encoder wrong and reset, then a contact", "N", 12, 3, rows::s1f},
    {"S2d", "in contact without noise: an hour, no false alarm", "N", 6, 4, rows::s2d},
    {"S2e", "in contact without noise: the sensor repeats itself", "N", 9, 3, rows::s2e},
    {"R1c", "robot packets lost, then a contact", "N", 12, 4, rows::r1c},
    {"R1a", "0.1 to 10 % of the robot's packets lost each way", "of the limits", 20, 5, rows::r1a},
    {"R1b", "the robot's packets late, twice, out of order", "of the limits", 28, 7, rows::r1b},
    {"R2", "controller not heard for 10 ms to 1.4 s, stops meanwhile", "of the limits", 40, 5,
     rows::r2},
    {"R3", "slave stopped for 5 ms to a minute", "of the limits", 28, 7, rows::r3},
    {"R3b", "slave late by up to a cycle, robot packets lost", "of the limits", 20, 5, rows::r3b},
    {"R3c", "slave and replies late together, controller not heard", "of the limits", 20, 5,
     rows::r3c},
    {"R4", "both computers asleep for 5 ms to a minute", "of the limits", 28, 7, rows::r4},
    {"R5", "an arm that answers zeros or beyond its ranges", "ms to stop", 12, 4, rows::r5},
    {"D3", "a master with another scene, from off and engaged", "ms engaged", 16, 4, rows::d3},
    {"X2a", "a million hostile sequences to the guard alone", "of the limits", 20, 2, rows::x2a},
    {"X2b", "20 000 hostile sequences to the whole slave", "of the limits", 8, 1, rows::x2b},
    {"X2c", "tools called anywhere with the hand still", "mm", 8, 2, rows::x2c},
    {"X2d", "a hand far out of reach, turned, that stands", "mm away", 80, 8, rows::x2d},
    {"X9a", "a second master at the same slave", "datagrams applied", 4, 1, rows::x9a},
    {"X4", "a stop at 30 % loss, a stop in a mad master's datagrams", "ms to stop", 20, 2,
     rows::x4},
    {"X11", "a recorded session to a slave that has just started", "cycles moved", 4, 1, rows::x11},
    {"X9b", "two operators at a time", "orders of another", 4, 1, rows::x9b},
};

}  // namespace

std::span<const FaultRow> fault_rows() { return kRows; }

FaultOutcome not_engaged() {
  FaultOutcome out;
  find(out, 1, "did not engage");
  return out;
}

}  // namespace handrail
