// A simulated operator who fastens the screw at the running programs: sees the tip as the rig says
// it, leads the page's cursor and calls tools, as the study's operator does. Simulated: results
// obtained with it must be labelled so.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "client/experiment/screw/screw_live.h"
#include "client/experiment/screw/step_thread.h"
#include "devices/hand/hand_model.h"
#include "proto/operator.pb.h"
#include "server/base/time.h"
#include "server/lab/study/screw/screw_person.h"

namespace handrail {

class ScrewSubject final : private ScrewPlace {
 public:
  // `scene` has a screw task.
  ScrewSubject(const Scene& scene, const OperatorParameters& person, std::uint64_t seed);

  // Before each trial: the how manieth of this person it is, from 1.
  void begin(ScrewMode mode, int number);
  // Lets the time pass until `now`, any clock, and gives the orders that it makes then.
  std::vector<pb::Request> act(Nanos now, const ScrewTold& told, const RigSight& rig,
                               ScrewLive::Stage stage);
  // One of these was refused: it is made again.
  void refused(const pb::Request& request);

  // Where its hand is, to lead the cursor by, frame M.
  Pose hand() const { return hand_.pose(); }
  const OperatorParameters& parameters() const { return person_; }
  // What it is doing; nothing before it begins.
  std::optional<ScrewPhase> phase() const;
  int misses() const { return mind_works_ ? mind_works_->misses() : 0; }

 private:
  bool pass(const ScrewKey& key) override;
  void start_clock() override;
  double now() const override { return now_; }
  OperatorModel& mind() override { return *mind_; }
  void leave_off() override { mind_->leave_off(hand_); }
  Pose tip() const override { return rig_.X_ST; }
  Pose told_tip() const override { return told_.X_ST; }
  Vec3 told_force() const override { return told_.contact; }
  double off_flats() const override { return rig_.off_flats; }
  bool tight() const override { return work_.is_tight(rig_.turned); }

  void live(bool thinks);
  void make_trial();

  Scene scene_;
  ScrewWork work_;
  OperatorParameters person_;
  std::uint64_t seed_;
  HandModel hand_;
  ScrewMode mode_ = ScrewMode::kNCNV;
  int number_ = 1;
  ScrewTold told_;
  RigSight rig_;
  ScrewLive::Stage stage_ = ScrewLive::Stage::kToStart;
  double now_ = 0.0;  // [s]
  double due_ = 0.0;  // an order that is made again and again [s]
  Nanos credit_ = 0;  // of time that has yet to pass
  Nanos last_ = -1;
  std::vector<pb::Request> orders_;
  std::optional<OperatorModel> mind_;
  std::optional<ScrewPerson> mind_works_;
  std::unique_ptr<StepThread> trial_;  // last: it ends first
};

}  // namespace handrail
