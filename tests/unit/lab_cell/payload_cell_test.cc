// A payload on the simulated rig: found by turning the tip about, and then no longer felt.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "devices/omni/omni_data.h"
#include "server/lab/cell/cell.h"
#include "server/master/haptic_settings.h"
#include "server/scene/scene_io.h"
#include "server/slave/follow_settings.h"
#include "server/task/payload_sampler.h"

namespace handrail {
namespace {

constexpr char kScene[] =
    "name: 'loaded' simulate { effect { servo_lag {} } effect { encoder_offsets {} }"
    "  effect { sensor_noise {} }"
    "  effect { gravity_sag { payload_kg: 0.5 centre_mm: [4, -2, 60] } }"
    "  effect { sensor_drift { n_per_s: 0 start_n: [1.5, -2, 0.7] start_n_m: [0.05, -0.02, 0.01] } "
    "} "
    "}";
const Payload kGiven{0.5, {0.004, -0.002, 0.06}, {{1.5, -2.0, 0.7}, {0.05, -0.02, 0.01}}};

class LoadedCell {
 public:
  explicit LoadedCell(const Payload& known) {
    const Result<Scene> scene = parse_scene("loaded.scene", kScene);
    EXPECT_TRUE(scene) << scene.message();
    CellOptions options;
    run_only_listed(*scene, options.rig);
    options.haptic = haptic_settings(*scene, omni_capabilities(false));
    options.follow = follow_settings(*scene, options.rig.controller.period, true, 1000.0, known);
    cell_ = std::make_unique<Cell>(options);
    HapticOrder engage;
    engage.kind = OrderKind::kEngage;
    for (int i = 0; i < 3000 && cell_->master_state().lead.session != SessionState::kEngaged; ++i) {
      cell_->tick(hand(), engage);
    }
    EXPECT_EQ(cell_->slave().state, SessionState::kEngaged);
  }
  // Turns the hand to `turn` (rotation vector, frame M) within 1.5 s, then rests as long.
  void turn_to(const Vec3& turn) {
    const Vec3 from = turn_;
    for (int i = 1; i <= 3000; ++i) {
      const double share = std::min(1.0, i / 1500.0);
      turn_ = from + share * share * (3.0 - 2.0 * share) * (turn - from);
      cell_->tick(hand());
      see(cell_->slave());
      if (i % 20 != 0) continue;
      const SlaveState& s = cell_->slave();
      const Quat q_TS = s.X_ST.q.conjugate();
      sampler.add(
          {to_seconds(cell_->now()), s.X_ST, {q_TS * s.f_E_S.force, q_TS * s.f_E_S.torque}});
    }
  }
  void turn_about() {
    for (const Vec3& turn : {Vec3(0, 0, 0), Vec3(0.45, 0, 0), Vec3(-0.45, 0, 0), Vec3(0, 0, 0.45),
                             Vec3(0, 0, -0.45), Vec3(0.4, 0, 0.4)}) {
      turn_to(turn);
    }
  }
  PayloadSampler sampler;
  double most = 0.0, least = 1e9;  // force felt [N]
  double most_torque = 0.0;        // [N m]
  bool contact = false;            // the bumper has moved the tip

 private:
  void see(const SlaveState& s) {
    EXPECT_EQ(s.state, SessionState::kEngaged);
    most = std::max(most, s.f_E_S.force.norm());
    least = std::min(least, s.f_E_S.force.norm());
    most_torque = std::max(most_torque, s.f_E_S.torque.norm());
    contact |= !s.ledger.off_S.col(static_cast<int>(FollowStage::kBumper)).isZero(0.0f);
  }
  HandReading hand() const {
    HandReading out;
    out.X_MH.q = rotation_exp(turn_);
    out.valid = true;
    return out;
  }
  Vec3 turn_ = Vec3::Zero();
  std::unique_ptr<Cell> cell_;
};

TEST(PayloadCell, IsFoundByTurningTheTipAboutAndThenNoLongerFelt) {
  LoadedCell before((Payload()));
  before.turn_about();
  const Result<PayloadFit> fit = fit_payload(before.sampler.samples());
  ASSERT_TRUE(fit) << fit.message();
  EXPECT_EQ(before.sampler.samples().size(), 6u);
  const Payload& found = fit->payload;
  EXPECT_NEAR(found.mass, kGiven.mass, 0.002);
  EXPECT_LT((found.centre_T - kGiven.centre_T).norm(), 5e-4);
  EXPECT_LT((found.bias_T.force - kGiven.bias_T.force).norm(), 0.02);
  EXPECT_LT((found.bias_T.torque - kGiven.bias_T.torque).norm(), 1e-3);
  EXPECT_LT(fit->force_left, 0.02);
  // What free air felt like: the weight, 4.9 N, and the bias, 2.6 N.
  EXPECT_GT(before.least, 4.9);

  LoadedCell after(found);
  after.turn_about();
  EXPECT_LT(after.most, 0.4) << "noise of 0.05 N an axis, and gravity 7 ms late";
  EXPECT_LT(after.most_torque, 0.03);
  EXPECT_FALSE(after.contact);
}

}  // namespace
}  // namespace handrail
