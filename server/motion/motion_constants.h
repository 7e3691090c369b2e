// Every number of this room that is neither a limit of the arm nor worked out from one.
#pragma once

namespace handrail {

// MOTION.md says what each decides, where it comes from, and in which range the tests hold.
struct MotionConstants {
  double plan_share = 0.97;  // of the guard's speed, acceleration and jerk that a plan uses
  double law_share = 0.92;   // of the plan's acceleration and jerk that the law uses
  double stop_jerks = 2.5;   // a stop takes at most v/a and so many a/j, or twice as many cycles
  double turn_length = 0.2;  // what a radian counts beside a metre [m]
  double damping = 3e-5;     // of the inverse that gives the joints' rates [m^2]
  double own_way = 1e-6;     // what a radian off the joints' own way counts beside the place [m^2]
  double together = 0.3;     // a way that takes longer is gone straight in place and turn [s]
  double slow = 0.02;        // a tip that moves less is as good as standing [m/s]
  double unheld = 2e-3;      // what may be that no tool holds: beside, past, away, behind [m]
  double from_face = 5e-3;   // of the workspace [m]
};
inline constexpr MotionConstants kMotion;

// What rounding needs: larger than its errors, smaller than anything that matters.
struct MotionRounding {
  double joint = 1e-12;    // a step that is none [rad]
  double place = 1e-12;    // a way that is none [m]
  double off = 3e-10;      // off the place that a step is to come to [m]
  double going = 1e-10;    // a step of the tip that has a direction [m], [rad by the turn's length]
  double coming = 1e-6;    // a way to the goal that has one, likewise
  double found = 1e-6;     // what is left of the way to the end of reach [m], [rad]
  double past = 1e-7;      // past its goal on a tool [m]; off a range's end [rad]
  double waver = 1e-5;     // the same of a slow tip that turns [m]
  double on = 5e-6;        // off its tool, its place having come as 32 bits [m]
  double from_end = 1e-5;  // of a joint's range [rad]
  double share = 1e-9;     // of a motion that is none
  double nothing = 1e-30;  // far below all that is divided by
  double landing = 2.0;    // an acceleration that comes and goes on whole cycles takes so many
  int corrections = 4;     // of a step by its place; half of them with one inverse
};
inline constexpr MotionRounding kTiny;

// Larger than any way, speed or part.
inline constexpr double kUnbounded = 1e9;

}  // namespace handrail
