// The manual gearshift of dissertation 2.3.2 as an experiment: N, 1 to 5, R and back to N.
#pragma once

#include <optional>
#include <string>

#include "client/experiment/wall_task.h"
#include "server/lab/walls/gear_driver.h"
#include "server/lab/walls/gear_judge.h"

namespace handrail {

// With the lever in neutral and held, the clock starts as the lever leaves it. Each gear is in when
// its lock has closed; another than the next counts as wrong, and the person goes on. The trial is
// done when the lever has come to rest in neutral after the last.
class GearshiftExperiment final : public WallTask {
 public:
  // `gate` is of `scene`, which outlives the experiment.
  GearshiftExperiment(const Scene& scene, GearGate gate);

 private:
  void restart() override;
  void watch(const WallTick& now) override;
  std::string words() const override;
  Aim aim(const WallTick& now) override;
  void measure(pb::WallTrial& out) const override;
  std::string measured() const override;
  bool all_in() const { return next_ == gate_.names().size(); }

  GearGate gate_;
  bool at_n_ = false;  // the lever was, and the clock may start
  std::optional<GearJudge> judge_;
  std::size_t counted_ = 0;  // of what was visited
  std::size_t next_ = 0;     // gear
  int wrong_ = 0;
  std::string wrong_gear_;  // the lever is in it, or was last; empty: the right one
  std::optional<GearDriver> driver_;
  double set_out_ = 0.0;  // the driver, on the master's clock [s]
};

}  // namespace handrail
