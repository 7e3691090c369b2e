// One millisecond of a simulated study: hand, device, both steps and the rig in virtual time.
#include <memory>

#include "devices/omni/omni_data.h"
#include "devices/omni/sim_omni.h"
#include "server/kinematics/rv2a.h"
#include "server/lab/cell/cell.h"
#include "server/master/haptic_settings.h"
#include "server/slave/follow_settings.h"
#include "tests/bench/percentile.h"

namespace handrail::bench {
namespace {

// 350 times faster than real time on one core.
constexpr double kTargetNs = 1e6 / 350.0;

std::unique_ptr<Cell> make_cell() {
  Scene scene;
  scene.name = "bench";
  scene.limits.joints = rv2a_limits();
  auto options = std::make_unique<CellOptions>();
  options->haptic = haptic_settings(scene, omni_capabilities(false));
  options->follow = follow_settings(scene, options->rig.controller.period, true, 1000.0);
  options->rig.controller.arm.geometry.d6 = scene.tip_length;
  options->transit = 2 * kMillisecond;
  return std::make_unique<Cell>(*options);
}

// Engaged, with a hand that goes to and fro and turns without ever resting.
class Drive {
 public:
  Drive() {
    (void)omni_.open();
    order_.kind = OrderKind::kEngage;
    while (cell_->slave().state != SessionState::kEngaged) (*this)();
    order_.kind = OrderKind::kNone;
  }

  const Pose& operator()() {
    if (!omni_.hand()->moving()) steer();
    const HapticSample sample = omni_.read(cell_->now());
    HandReading hand;
    hand.X_MH = sample.X_MH;
    hand.v_MH = sample.v_MH;
    hand.valid = sample.valid;
    cell_->tick(hand, order_);
    omni_.write(cell_->master().f_H_M);
    if (cell_->robot_cycle()) tip_ = cell_->rig().controller().arm().true_tip();
    return tip_;
  }

 private:
  void steer() {
    HandIntent intent;
    intent.displacement_M = Vec3(there_ ? -0.02 : 0.02, there_ ? -0.01 : 0.01, 0.0);
    intent.rotation_M = Vec3(0.0, 0.0, there_ ? -0.2 : 0.2);
    intent.duration = 1.5;
    omni_.hand()->steer(intent);
    there_ = !there_;
  }

  std::unique_ptr<Cell> cell_ = make_cell();
  SimOmni omni_{HandOptions{}, false};
  HapticOrder order_;
  bool there_ = false;
  Pose tip_;
};

// Batches of a whole number of robot cycles: 71 ms.
void BM_LabTick(benchmark::State& state) {
  run(state, "lab, one millisecond of hand and cell", 71, kTargetNs, Drive{});
}
BENCHMARK(BM_LabTick);

}  // namespace
}  // namespace handrail::bench
