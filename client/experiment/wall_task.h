// What the experiments among walls, gearshift and wrench, have in common.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/experiment/experiment_task.h"
#include "client/experiment/wall_hand.h"
#include "server/lab/study/linear/linear_trial.h"
#include "server/lab/walls/wall_bench.h"

namespace handrail {

// What the master says of a hand among walls, as the lab's judges see it. The force is what the
// device was told, that of the hand its opposite; time on the master's clock. No velocity.
WallTick wall_tick_of(const pb::Status& now, const std::vector<std::string>& places);

// A trial among walls ends as it ends for its kind, after kWallLimit, or when the master is gone or
// its scene is loaded anew while the clock runs.
inline constexpr double kWallLimit = 120.0;  // four times what a slow hand takes, our choice [s]

class WallTask : public ExperimentTask {
 public:
  std::vector<std::string> modes() const override { return {"walls"}; }
  std::string scene_of(int) const override { return scene_.name; }
  // The dissertation tells of neither practice nor repetition here: our choice.
  ExperimentRules rules() const override { return {1, 2}; }
  Status suits(const pb::Status&) const override { return Status::ok(); }
  Status simulate(const std::string& subject) override;

  pb::ExperimentTrial begin(const TrialNext& next) override;
  void see(const pb::Status* now) override;
  bool ended() const override { return ended_; }
  TaskPrompt prompt() const override;
  void act(const pb::Status& now, const TaskHelp& help) override;
  Pose hand() const override { return hand_->pose(); }
  void fill(pb::ExperimentTrial& out) const override;
  std::string outcome() const override;
  Status write_trace(const std::string& file) const override;

 protected:
  // `scene` has walls and outlives the task; `places` are its detent's.
  WallTask(const Scene& scene, std::vector<std::string> places)
      : scene_(scene), places_(std::move(places)) {}

  // A trial begins.
  virtual void restart() = 0;
  // Every moment of it.
  virtual void watch(const WallTick& now) = 0;
  virtual std::string words() const = 0;
  virtual std::optional<Vec2> ball() const { return std::nullopt; }
  // Where a simulated person wants the hand to be, and whether it is let go.
  struct Aim {
    Vec2 p, v = Vec2::Zero();  // [m], [m/s]
    bool lets_go = false;
  };
  virtual Aim aim(const WallTick& now) = 0;
  virtual void measure(pb::WallTrial& out) const = 0;
  virtual std::string measured() const = 0;

  void start_clock(double t);
  void end(TrialEnd how, double t);
  bool timed() const { return started_ && !ended_; }
  double since_start(double t) const { return t - *started_; }  // [s]
  // As far as the device says.
  bool held() const { return held_; }
  // Of a simulated person, times the usual speed; else 1.
  double pace() const { return hand_ ? hand_->pace() : 1.0; }
  const Scene& scene() const { return scene_; }

 private:
  void add(const WallTick& now);

  const Scene& scene_;
  std::vector<std::string> places_;
  std::unique_ptr<WallHand> hand_;  // null: a person
  TrialNext next_;
  WallTick now_;
  bool seen_ = false, held_ = false, ended_ = false;
  std::uint64_t epoch_ = 0;  // of the scene, when the clock started
  std::optional<double> started_;
  TrialEnd how_ = TrialEnd::kDone;
  double time_ = 0.0;                                // [s]
  double most_wall_ = 0.0, sum_ = 0.0, most_ = 0.0;  // force [N]
  int touched_ = 0;                                  // moments at a wall
  double apart_ = 0.0;                               // hand from lever [m]
  std::vector<WallTick> trace_;
};

}  // namespace handrail
