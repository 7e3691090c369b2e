// Screw fastening as an experiment: the way to the start, the loose screw, the trial, who makes it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/api/rig_client.h"
#include "client/experiment/experiment_task.h"
#include "client/experiment/screw/screw_subject.h"

namespace handrail {

// The scene of a mode: with protection or without.
std::string screw_scene(ScrewMode mode);

class ScrewExperiment final : public ExperimentTask {
 public:
  // `scene` has a screw task and outlives the experiment. `rig`: the status socket of the simulated
  // rig, which says what happens at the screw; empty: none is named.
  ScrewExperiment(const Scene& scene, const std::string& rig);

  std::vector<std::string> modes() const override;
  std::string scene_of(int mode) const override;
  ExperimentRules rules() const override { return {}; }
  Status suits(const pb::Status& now) const override;
  Status simulate(const std::string& subject) override;

  pb::ExperimentTrial begin(const TrialNext& next) override;
  void see(const pb::Status* now) override;
  bool ended() const override { return live_->stage() == ScrewLive::Stage::kEnded; }
  TaskPrompt prompt() const override { return {live_->prompt(), std::nullopt}; }
  void act(const pb::Status& now, const TaskHelp& help) override;
  Pose hand() const override { return subject_->hand(); }
  void fill(pb::ExperimentTrial& out) const override;
  std::string outcome() const override;
  Status write_trace(const std::string& file) const override {
    return write_screw_trace(file, live_->rows());
  }

 private:
  // What the rig has to say since it was last asked; false: it does not answer.
  bool look(std::vector<RigSight>& out);
  void to_start(const pb::Status& now, const TaskHelp& help);
  Vec3 on_the_way(const Vec3& p_ST);
  void loosen(const TaskHelp& help);
  void open_clutch(const pb::Status& now, const TaskHelp& help);
  void say_once(const std::string& text, const TaskHelp& help);

  const Scene& scene_;
  std::string place_;
  std::unique_ptr<RigClient> rig_;  // null: none is named
  Pose X_start_;
  std::unique_ptr<ScrewSubject> subject_;  // null: a person
  TrialNext next_;
  std::optional<ScrewLive> live_;
  ScrewTold told_;
  std::optional<RigSight> newest_;
  std::uint64_t heard_ = 0;   // the newest moment's number
  std::optional<Vec3> lift_;  // to here first: the key was in the screw
  Nanos again_at_ = 0, loosen_at_ = 0;
  bool closed_ = false;  // the clutch, for who waits at the start
  std::string said_;
};

}  // namespace handrail
