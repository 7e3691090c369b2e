// The handle's sensor in the haptic loop: shown and kept, and nothing else is another for it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "proto/record.pb.h"
#include "server/master/status_report.h"
#include "server/record/came_io.h"
#include "server/record/tick_io.h"
#include "tests/unit/master/loop_bench.h"

namespace handrail {
namespace {

// A device whose simulated hand pushes.
class PushedDevice : public ScriptedDevice {
 public:
  std::optional<Vec3> simulated_push() const noexcept override { return push; }
  std::optional<Vec3> push;
};

const Vec3 kStick(0.0, 0.0, 0.15);

HandleReading felt_push(const Vec3& force) { return {HandleState::kSound, {force, Vec3::Zero()}}; }

class HandleLoop : public LoopBench {
 protected:
  HandleLoop() {
    loop.emplace(device, LoopScene{settings}, boxes, now, tap.get(), HandleSetup{kStick});
  }

  pb::RecordedTick kept() {
    KeptTick one;
    pb::RecordedTick out;
    while (tap->take(one)) put(one, out);
    return out;
  }
  std::unique_ptr<MasterTap> tap = std::make_unique<MasterTap>();
};

TEST_F(HandleLoop, ShowsAndKeepsWhatIsMeasuredInM) {
  device.sample.X_MH.q = rotation_exp(Vec3(0.0, 0.0, M_PI_2));
  boxes.handle.publish(felt_push(Vec3(2.0, 0.0, 0.0)));
  tick();
  const HandleForce& is = report.handle;
  EXPECT_TRUE(is.f_H_M.force.isApprox(Vec3(0.0, -2.0, 0.0), 1e-12));
  EXPECT_TRUE(is.stick_torque_M.isApprox(Vec3(0.3, 0.0, 0.0), 1e-12));
  const pb::RecordedTick recorded = kept();
  ASSERT_EQ(recorded.handle_size(), 6);
  EXPECT_NEAR(recorded.handle(1), -2.0, 1e-12);
  KeptTick back;
  ASSERT_TRUE(take_all(recorded, back));
  EXPECT_TRUE(back.handle.sound());
  EXPECT_EQ(back.handle.f_H_M.force, is.f_H_M.force);

  MasterIdentity identity;
  identity.handle_sensor = "made-up";
  const pb::Status s = status_report(identity, report, news.state, LinkSnapshot(), now);
  EXPECT_EQ(s.handle().state(), "sound");
  EXPECT_NEAR(s.handle().force().force_n(1), -2.0, 1e-12);
  EXPECT_NEAR(s.handle().stick_torque_n_m(0), 0.3, 1e-12);
}

TEST_F(HandleLoop, WithoutAReadingThereIsNoneAndNoZero) {
  boxes.handle.publish(felt_push(Vec3(2.0, 0.0, 0.0)));
  tick();
  boxes.handle.publish({HandleState::kSilent, {}});
  tick();
  EXPECT_EQ(kept().handle_size(), 0);
  MasterIdentity identity;
  identity.handle_sensor = "made-up";
  pb::Status s = status_report(identity, report, news.state, LinkSnapshot(), now);
  EXPECT_EQ(s.handle().state(), "silent");
  EXPECT_FALSE(s.handle().has_force());
  EXPECT_EQ(s.handle().stick_torque_n_m_size(), 0);
  s = status_report(MasterIdentity(), HapticReport(), news.state, LinkSnapshot(), now);
  EXPECT_FALSE(s.has_handle()) << "no sensor is configured";
}

TEST_F(HandleLoop, ARecordedReadingOfAnotherLengthIsNone) {
  boxes.handle.publish(felt_push(Vec3(2.0, 0.0, 0.0)));
  tick();
  pb::RecordedTick recorded = kept();
  recorded.add_handle(1.0);
  KeptTick back;
  EXPECT_EQ(take_all(recorded, back).message(), "handle has 7 numbers, expected 6");
}

// The same drive under force: where the hand pulls, what the device and the slave are told of it.
class Drive : public LoopBench {
 public:
  // `worst`: a sensor says the worst meanwhile.
  std::vector<Vec3> told(bool worst) {
    if (worst) loop.emplace(device, LoopScene{settings}, boxes, now, nullptr, HandleSetup{kStick});
    pull_off_a_line();
    std::vector<Vec3> out;
    for (int i = 0; i < 50; ++i) {
      device.sample.X_MH.p.x() += 1e-5;
      if (worst && i % 3 == 0) boxes.handle.publish({HandleState::kFaulty, {}});
      if (worst && i % 3 != 0) boxes.handle.publish(felt_push(Vec3(1e6, -1e6, 1e6)));
      tick();
      out.insert(out.end(), {report.out.f_H_M.force, device.written.force, report.out.link.X_SU.p});
    }
    return out;
  }

 private:
  void TestBody() override {}
};

TEST(HandleLoopDrive, NothingIsAnotherForIt) {
  Drive with, without;
  const std::vector<Vec3> told = with.told(true);
  ASSERT_EQ(told.size(), 150u);
  EXPECT_GT(told.back().norm(), 0.1);
  EXPECT_EQ(told, without.told(false));
}

TEST_F(HandleLoop, TheSimulatedSensorIsToldInTheHandlesAxes) {
  SimHandleSensor sensor;
  PushedDevice pushed;
  pushed.sample.X_MH.q = rotation_exp(Vec3(0.0, 0.0, M_PI_2));
  pushed.push = Vec3(0.0, 2.0, 0.0);
  HapticLoop driven(pushed, LoopScene{settings}, boxes, now, nullptr, HandleSetup{kStick, &sensor});
  driven.tick(now + kMillisecond);
  FtSample sample;
  ASSERT_TRUE(sensor.poll(now, sample));
  EXPECT_TRUE(sample.wrench.force.isApprox(Vec3(2.0, 0.0, 0.0), 1e-12));
  pushed.push.reset();
  driven.tick(now + 2 * kMillisecond);
  EXPECT_FALSE(sensor.poll(now, sample));
}

}  // namespace
}  // namespace handrail
