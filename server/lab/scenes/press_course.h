// A course that leads the tip of the simulated arm through what a scene lists to touch.
#pragma once

#include <vector>

#include "devices/rig/rig.h"
#include "server/base/status.h"
#include "server/model/scene.h"

namespace handrail {

// Servo targets, one a controller cycle, and where they would lead a rigid arm without lag. Ends
// where it begins.
struct PressCourse {
  std::vector<JointVector> q;  // [rad]
  std::vector<Pose> X_ST;
};

// Onto the first plane, box or cylinder listed and 1 mm further, a moment's rest, 10 mm along it
// and back off; or into the socket until 1 mm past its bottom, a third of a turn clockwise and out
// again; 10 mm to and fro where the arm stands if there is nothing to touch. No bumper acts. The
// error names the place that the arm cannot reach.
Result<PressCourse> press_course(const Scene& scene);

// What the rig runs for a scene: its list, or what a rig does by itself.
Simulate simulated_by(const Scene& scene);

// What a course came to, over all sensor periods; SI.
struct PressResult {
  double peak = 0.0;        // largest true contact force [N]
  double mean = 0.0;        // over the periods above 2 N [N]
  double tip_off = 0.0;     // of the true tip from where it was led, RMS [m]
  double read_off = 0.0;    // of the tip as the encoders read it from the true one, RMS [m]
  double sensor_off = 0.0;  // of the force read from that of contact, RMS [N]
  double screw = 0.0;       // tightened by so much [rad]
};

// A rig that runs a scene's list and follows a course, over and over.
class PressRun {
 public:
  // `course` is kept by the caller. The arm stands at its beginning.
  PressRun(const Scene& scene, const PressCourse& course);
  // A millisecond, without allocation.
  void tick() noexcept;
  // Times round the course.
  int rounds() const noexcept { return rounds_; }
  const Rig& rig() const noexcept { return rig_; }
  const Pose& led() const noexcept { return course_->X_ST[at_]; }

 private:
  const PressCourse* course_;
  Rig rig_;
  Nanos now_ = 0;
  std::size_t at_ = 0;
  int rounds_ = 0;
};

// Once round the course.
PressResult run_press(const Scene& scene, const PressCourse& course);

}  // namespace handrail
