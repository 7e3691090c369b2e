// A simulated operator at the running programs: it sees the tip as the master says it, leads the
// page's cursor, calls tools by their names and marks. Simulated: results obtained with it must be
// labelled so.
#pragma once

#include <vector>

#include "client/experiment/linear_live.h"
#include "devices/hand/hand_model.h"
#include "devices/hand/operator_model.h"
#include "proto/operator.pb.h"
#include "server/base/time.h"
#include "server/model/scene.h"

namespace handrail {

// What it sees and feels.
struct SubjectSight {
  Pose X_ST;                  // the tip
  Pose X_MH;                  // the device
  Vec3 f_H_M = Vec3::Zero();  // on the hand [N]
  bool drives = false;
  bool fault = false;
};

class SimulatedSubject {
 public:
  SimulatedSubject(const Scene& scene, const OperatorParameters& person, std::uint64_t seed);

  // Before each trial: the how manieth of this person it is, from 1.
  void begin(StudyMode mode, int number);
  // Lets the time pass until `now`, any clock, and gives the orders that it makes then.
  std::vector<pb::Request> step(Nanos now, const SubjectSight& sight, const LinearLive& live);
  // One of these was refused, so that it is made again.
  void refused(const pb::Request& request);

  // Where its hand is, to lead the cursor by, frame M.
  Pose hand() const { return hand_.pose(); }

 private:
  bool due(double seconds);
  void live_on(Nanos now, const SubjectSight& sight);
  void begin_stage();
  void act(const LinearLive& live, std::vector<pb::Request>& orders);

  LinearTask task_;
  OperatorParameters person_;
  OperatorModel mind_;
  HandModel hand_;
  StudyMode mode_ = StudyMode::kFree;
  double pause_ = 0.0;  // to decide [s]
  LinearLive::Stage stage_ = LinearLive::Stage::kEnded;
  double now_ = 0.0;      // [s]
  double acts_at_ = 0.0;  // [s]
  bool called_ = false, aims_ = false;
  Nanos last_ = -1;
};

}  // namespace handrail
