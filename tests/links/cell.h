// One link between two real daemons: what both sides run, and what is found out.
#pragma once

#include <string>

#include "server/base/status.h"
#include "server/lab/links/link_map.h"

namespace handrail::links {

// What the hand does in a run. Each has one of its own, as in the lab.
enum class Motion { kSines, kStrokes };

// How long a run takes.
struct RunPlan {
  Motion motion = Motion::kSines;
  double engage_s = 10.0;  // for how long it is tried
  double drive_s = 60.0;   // kSines: how long the arm is led; kStrokes: until their end, see below
  int strokes = 8;         // kStrokes: after a half one
};
// From the recording's start to the end of the last stroke [s].
double strokes_end(const RunPlan& plan, const LinkCase& link);

// Of the hand, 10 ms a line, as a RECORDED device plays it: "t_s,x_mm,y_mm,z_mm". kSines: three of
// up to 18 mm and 0.3 to 0.9 Hz drawn from the seed. kStrokes: rest while it is engaged, then from
// side to side faster than the arm.
std::string hand_recording(const RunPlan& plan, const LinkCase& link);
// When the hand leaves for stroke `i`, 0 being the half one, from the recording's start [s].
double stroke_start(const RunPlan& plan, const LinkCase& link, int i);

// As handrail-netfault reads it.
std::string network_text(const LinkCase& link);

// Runs rig and slave on one side of handrail-netfault and master and an operator on the other.
// `folder` is made, and holds what they print. The error says what went wrong; a link that refuses
// is none.
Result<LinkFigures> measure(const RunPlan& plan, const LinkCase& link, const std::string& folder);

// The program of each side, in its own namespaces: the exit code.
int run_near(const RunPlan& plan, const std::string& folder);
int run_far(const std::string& folder);

// What the slave's last lines say of holds. The error says that they do not.
Status read_holds(const std::string& log, LinkFigures& out, double minutes);

}  // namespace handrail::links
