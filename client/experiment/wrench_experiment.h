// The omni-directional wrench of dissertation 2.3.1 as two experiments: loops behind the ball that
// tighten the screw, and then as many that loosen it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/experiment/wall_task.h"
#include "server/lab/walls/wrench_path.h"

namespace handrail {

inline constexpr int kWrenchLoops = 2;       // each way; the dissertation makes four
inline constexpr double kLooseningC = 15.0;  // c of Fig. 2.9 [N s/(m rad)]

enum class WrenchWay : std::uint8_t { kTighten, kTightenAndLoosen };

// The screw is loose at first: a scene in which it has been turned is loaded anew. The ball waits
// where it sets out, until the lever has been held there for a second. Then the clock runs, until
// the lever has come around after it. c begins as the scene has it, and where the screw is loosened
// too as kLooseningC; what it is after that is the person's to say.
class WrenchExperiment final : public WallTask {
 public:
  // `scene` outlives the experiment, and `path` is of it.
  WrenchExperiment(const Scene& scene, const WrenchPath& path, WrenchWay way);

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
  int loosen_;       // loops
  double wanted_c_;  // as a trial begins
  GuidingBall ball_;
  bool loose_ = false;
  bool ready_ = false;     // and c is what it is to be
  double again_at_ = 0.0;  // the order that makes it so, the master's clock [s]
  bool refused_ = false;   // and that was said
  std::optional<double> there_since_;
  double now_ = 0.0;  // since the clock started [s]
  double turned_ = 0.0, c_ = 0.0;
  double most_off_ = 0.0, sum_ = 0.0;  // hand from ball [m]
  int seen_ = 0;
};

}  // namespace handrail
