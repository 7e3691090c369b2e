// The linear movement as an experiment: the way to A, the trial, and who makes it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/experiment/experiment_task.h"
#include "client/experiment/linear_live.h"
#include "client/experiment/simulated_subject.h"
#include "client/experiment/trace_csv.h"

namespace handrail {

class LinearExperiment final : public ExperimentTask {
 public:
  // `scene` has a task block and outlives the experiment.
  explicit LinearExperiment(const Scene& scene) : scene_(scene) {}

  std::vector<std::string> modes() const override;
  std::string scene_of(int) const override { return scene_.name; }
  ExperimentRules rules() const override { return {}; }
  Status suits(const pb::Status& now) const override;
  Status simulate(const std::string& subject) override;

  pb::ExperimentTrial begin(const TrialNext& next) override;
  void see(const pb::Status* now) override;
  bool ended() const override { return live_->stage() == LinearLive::Stage::kEnded; }
  TaskPrompt prompt() const override { return {live_->prompt(), std::nullopt}; }
  void act(const pb::Status& now, const TaskHelp& help) override;
  Pose hand() const override { return subject_->hand(); }
  void fill(pb::ExperimentTrial& out) const override;
  std::string outcome() const override;
  Status write_trace(const std::string& file) const override {
    return handrail::write_trace(file, trace_);
  }

 private:
  void to_a(const pb::Status& now, const TaskHelp& help);
  void open_clutch(const pb::Status& now, const TaskHelp& help);

  const Scene& scene_;
  std::unique_ptr<SimulatedSubject> subject_;  // null: a person
  TrialNext next_;
  std::optional<LinearLive> live_;
  LiveSample sample_;
  std::vector<TraceRow> trace_;
  Nanos again_at_ = 0;
  bool closed_ = false;   // the clutch, for who waits at A
  bool refused_ = false;  // and that was said
};

}  // namespace handrail
