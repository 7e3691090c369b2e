// The omni-directional wrench of dissertation 2.3.1 as an experiment: two loops behind the ball.
#pragma once

#include <optional>
#include <string>

#include "client/experiment/wall_task.h"
#include "server/lab/walls/wrench_path.h"

namespace handrail {

inline constexpr int kWrenchLoops = 2;  // that tighten; the dissertation makes four

// The screw is loose at first: a scene in which it has been turned is loaded anew. The ball waits
// where it sets out, until the lever has been held there for a second. Then the clock runs, until
// the lever has come around after it.
class WrenchExperiment final : public WallTask {
 public:
  // `scene` outlives the experiment, and `path` is of it.
  WrenchExperiment(const Scene& scene, const WrenchPath& path);

  void act(const pb::Status& now, const TaskHelp& help) override;

 private:
  void restart() override;
  void watch(const WallTick& now) override;
  std::string words() const override;
  std::optional<Vec2> ball() const override { return ball_.p(); }
  Aim aim(const WallTick& now) override;
  void measure(pb::WallTrial& out) const override;
  std::string measured() const override;

  WrenchPath path_;
  GuidingBall ball_;
  bool loose_ = false;
  Nanos again_at_ = 0;    // the scene's load
  bool refused_ = false;  // and that was said
  std::optional<double> there_since_;
  double now_ = 0.0;  // since the clock started [s]
  double turned_ = 0.0, c_ = 0.0;
  double most_off_ = 0.0, sum_ = 0.0;  // hand from ball [m]
  int seen_ = 0;
};

}  // namespace handrail
