// The 2-DOF joystick, over a stand-in for libcomedi.
#include "devices/comedi/comedi_joystick.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <utility>

#include "devices/comedi/comedi_joystick_driver.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/comedi/comedi_bench.h"

namespace handrail {
namespace {

using test::ComediState;
using ::testing::HasSubstr;

class ComediJoystickTest : public test::ComediBench {
 protected:
  void SetUp() override {
    ComediBench::SetUp();
    options.place = place;
    options.homing = StickHoming::kCentre;
    card([](ComediState& s) {
      s.driver = "s626";
      s.board = "s626";
      s.subdevices = multi();
    });
  }
  void TearDown() override {
    device.reset();
    test.reset();
    // Whatever became of it, nothing pushes.
    if (opened) {
      EXPECT_EQ(volts(0), 0.0);
      EXPECT_EQ(volts(1), 0.0);
    }
    ComediBench::TearDown();
  }
  void open() {
    device = std::make_unique<ComediJoystick>(options);
    const Status done = device->open();
    ASSERT_TRUE(done) << done.message();
    opened = true;
  }
  std::string open_error() {
    ComediJoystick fails(options);
    return fails.open().message();
  }
  HapticSample read() { return device->read(monotonic_now()); }
  bool valid(bool wanted = true) {
    return becomes([&] { return read().valid == wanted; });
  }
  // 2122 counts are 200 mm at the tip.
  void turn(int motor, int counts) {
    card([&](ComediState& s) {
      s.subdevices[3].values[static_cast<std::size_t>(motor)] =
          static_cast<unsigned int>(counts) & 0xffffff;
    });
  }
  // At the output, to the nearest of its 65536 steps.
  double volts(std::size_t channel) {
    const unsigned int raw = card([&](ComediState& s) { return s.subdevices[1].values[channel]; });
    return raw == 32768 ? 0.0 : -10.0 + 20.0 * raw / 65535.0;
  }
  // Keeps writing until the output is so.
  bool pushes(std::size_t channel, double wanted, const Vec3& written) {
    return becomes([&] {
      device->write({written, Vec3::Zero()});
      return std::abs(volts(channel) - wanted) < 2e-4;
    });
  }

  ComediJoystickOptions options;
  std::unique_ptr<ComediJoystick> device;
  std::unique_ptr<SelfTest> test;
  bool opened = false;
};

TEST_F(ComediJoystickTest, OpeningTakesAwayWhatWasLeftAtTheOutputs) {
  EXPECT_GT(volts(0), 5.0);
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(volts(0), 0.0);
  EXPECT_EQ(volts(1), 0.0);
  EXPECT_GT(volts(2), 5.0);  // not ours
  EXPECT_EQ(device->card(), "s626, driven by s626");
  card([](ComediState& s) { s.subdevices[1].values[2] = 32768; });
}

// 10000 counts are a turn, at 15 cm 942.5 mm.
TEST_F(ComediJoystickTest, CountsAreTheTipsWay) {
  turn(0, 100);
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  EXPECT_TRUE(read().X_MH.p.isZero(0.0));
  turn(0, 100 + 1000);
  turn(1, -200);
  ASSERT_TRUE(becomes([&] { return read().X_MH.p.y() < 0.0; }));
  EXPECT_TRUE(read().X_MH.p.isApprox(Vec3(0.0942478, -0.0188496, 0.0), 1e-5));
  options.counts_per_turn = {-10000.0, 20000.0};
  turn(0, 0);
  turn(1, 0);
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  turn(0, 1000);
  turn(1, -200);
  ASSERT_TRUE(becomes([&] { return read().X_MH.p.y() < 0.0; }));
  EXPECT_TRUE(read().X_MH.p.isApprox(Vec3(-0.0942478, -0.0094248, 0.0), 1e-5));
}

TEST_F(ComediJoystickTest, ItsVelocityIsThatOfTheTip) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  int counts = 0;
  double fastest = 0.0;
  for (int i = 0; i < 300; ++i) {
    turn(0, counts += 2);  // 0.1885 mm a ms, if the test is on time
    fastest = std::max(fastest, read().v_MH.x());
    sleep_until(monotonic_now() + kMillisecond);
  }
  EXPECT_GT(fastest, 0.05);
  EXPECT_TRUE(becomes([&] { return std::abs(read().v_MH.x()) < 1e-6; }));
}

// 3 N at 15 cm are 0.45 N m; 10 V at 3.8 N m make 1.184 V of it.
TEST_F(ComediJoystickTest, AForceIsAVoltageOfEachMotor) {
  options.volts_per_n_m = {10.0 / 3.8, -2.0};
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  EXPECT_TRUE(pushes(0, 1.18421, Vec3(3.0, 4.0, 9.0)));
  EXPECT_TRUE(pushes(1, -1.2, Vec3(3.0, 4.0, 9.0)));  // 0.6 N m
  EXPECT_TRUE(pushes(0, 10.0, Vec3(1e9, 0.0, 0.0)));
  EXPECT_TRUE(pushes(0, 0.0, Vec3(std::nan(""), 0.0, 0.0)));
}

TEST_F(ComediJoystickTest, ALoopThatFallsSilentLetsGo) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  ASSERT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
  EXPECT_TRUE(becomes([&] { return volts(0) == 0.0; }));
}

TEST_F(ComediJoystickTest, ClosingSetsTheTorquesToZero) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  ASSERT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
  device->write({Vec3(3.0, 0.0, 0.0), Vec3::Zero()});
  device->close();
  EXPECT_EQ(volts(0), 0.0);
  EXPECT_FALSE(read().valid);
  device->close();
}

TEST_F(ComediJoystickTest, BeforeItIsHomedNothingIsValidAndNothingPushes) {
  options.homing = StickHoming::kStops;
  ASSERT_NO_FATAL_FAILURE(open());
  for (const int way : {400, -1710, 0}) {
    turn(0, way);
    for (int i = 0; i < 20; ++i) {
      device->write({Vec3(3.0, 3.0, 0.0), Vec3::Zero()});
      ASSERT_FALSE(read().valid);
      ASSERT_EQ(volts(0), 0.0);
      sleep_until(monotonic_now() + kMillisecond);
    }
  }
  ASSERT_TRUE(becomes([&] { return (void)read(), device->tick().reached[0]; }));
  turn(1, -1000);
  ASSERT_TRUE(becomes([&] { return (void)read(), device->tick().seen[1] > 0.09; }));
  turn(1, 1100);
  ASSERT_TRUE(valid());
  EXPECT_NEAR(read().X_MH.p.x(), 655 * kJoystickResolution, 1e-6);
  EXPECT_NEAR(read().X_MH.p.y(), 1050 * kJoystickResolution, 1e-6);
  EXPECT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
  // Further than there is room for: counts are wrong, and the force goes.
  turn(1, 1500);
  EXPECT_TRUE(valid(false));
  device->write({Vec3(3.0, 0.0, 0.0), Vec3::Zero()});
  EXPECT_TRUE(becomes([&] { return volts(0) == 0.0; }));
  EXPECT_TRUE(device->tick().too_far);
}

TEST_F(ComediJoystickTest, ButtonsAreDigitalInputs) {
  options.button_channels = {2, 0, 5};
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->capabilities().buttons, 3);
  EXPECT_EQ(device->capabilities().dynamics.delay, 0.25e-3);
  EXPECT_EQ(read().buttons, 0u);
  card([](ComediState& s) { s.subdevices[2].values[5] = 0; });
  EXPECT_TRUE(becomes([&] { return read().buttons == 4u; }));
  options.button_low = false;
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_TRUE(becomes([&] { return read().buttons == 3u; }));
}

TEST_F(ComediJoystickTest, UnpluggedAHundredTimesItLetsGoAndComesBack) {
  options.reopen_pause = kMillisecond;
  ASSERT_NO_FATAL_FAILURE(open());
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(valid()) << i;
    card([&](ComediState& s) {
      s.open_error = ENOENT;
      (i % 2 == 0 ? s.read_error : s.write_error) = ENODEV;
    });
    ASSERT_TRUE(valid(false)) << i;
    card([](ComediState& s) { s.open_error = s.read_error = s.write_error = 0; });
  }
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->tick().losses, 100u);
  EXPECT_TRUE(device->tick().there);
}

// A loop that waits for the thread's turns answers in them: what it pushes belongs to the counts
// that it has just read.
TEST_F(ComediJoystickTest, AForceActsInTheTurnOfItsReading) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  Nanos due = monotonic_now();
  int in_turn = 0;
  bool in_a_row = false;
  std::uint64_t turn_before = 0;
  for (int i = 0; i < 1500; ++i) {
    due = device->wait(due) + kMillisecond;
    const bool missed = read().force_missed;
    const JoystickTick& tick = device->tick();
    const bool next = tick.ticks == turn_before + 1;
    turn_before = tick.ticks;
    // Of turns that were taken one after the other: what acted in the last was written in it.
    if (std::exchange(in_a_row, next) && next && !missed && i > 1000) {
      ++in_turn;
      ASSERT_EQ(tick.force.x(), i % 2 == 0 ? 2.0 : 1.0) << i;
    }
    device->write({Vec3(i % 2 == 0 ? 1.0 : 2.0, 0.0, 0.0), Vec3::Zero()});
  }
  EXPECT_GT(in_turn, 0);
}

TEST_F(ComediJoystickTest, ReadingAndWritingDoNotAllocate) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  const test::NoAllocation guard("joystick");
  for (int i = 0; i < 1000; ++i) {
    (void)read();
    device->write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()});
  }
}

TEST_F(ComediJoystickTest, CountersOfNationalInstrumentsAreSetUp) {
  options.setup = EncoderSetup::kNiX4;
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_EQ(card([](ComediState& s) { return s.counter_mode; }), 0x2030000u);
  EXPECT_EQ(card([](ComediState& s) { return s.armed; }), 2);
  device.reset();
  card([](ComediState& s) { s.setup_error = EINVAL; });
  EXPECT_THAT(open_error(), HasSubstr("encoder right-left: the counter at subdevice 3 cannot be "
                                      "set up as one of National Instruments"));
}

TEST_F(ComediJoystickTest, WhatTheCardHasNotIsNamed) {
  card([](ComediState& s) { s.subdevices[3].type = 0; });
  EXPECT_THAT(open_error(), HasSubstr("joystick: comedi: /dev/comedi0: encoder: s626, driven by "
                                      "s626 has no counters"));
  card([](ComediState& s) {
    s.subdevices = multi();
    s.subdevices[3].max_data = 255;
  });
  EXPECT_THAT(open_error(),
              HasSubstr("encoder right-left: channel 0 counts to 255, expected 65535"));
  card([](ComediState& s) {
    s.subdevices = multi();
    s.subdevices[1].min = 0.0;
  });
  EXPECT_THAT(open_error(), HasSubstr("torque right-left: channel 0 gives 0 to 10, expected volts "
                                      "of both signs"));
  card([](ComediState& s) { s.subdevices = multi(), s.other_has_torques = true; });
  EXPECT_THAT(open_error(), HasSubstr("its torques are another program's; end that program"));
  card([](ComediState& s) { s.other_has_torques = false, s.write_error = EIO; });
  EXPECT_THAT(open_error(), HasSubstr("its torques cannot be set to zero: Input/output error"));
  card([](ComediState& s) { s.write_error = 0, s.read_error = EIO; });
  EXPECT_THAT(open_error(), HasSubstr("its inputs cannot be read: Input/output error"));
  card([](ComediState& s) { s.read_error = 0; });
  options.place.board = "s626b";
  EXPECT_THAT(open_error(), HasSubstr("is 's626', driven by s626, expected 's626b'"));
}

TEST_F(ComediJoystickTest, LookingForItSetsNothing) {
  ComediJoystickDriver driver(options);
  const std::vector<Sighting> seen = driver.probe();
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].place, HANDRAIL_COMEDI_STAND_IN);
  EXPECT_EQ(seen[1].readiness, Readiness::kReady);
  EXPECT_THAT(seen[1].fact, HasSubstr("s626, driven by s626: two counters, two voltages"));
  EXPECT_EQ(card([](ComediState& s) { return s.writes; }), 0);
  EXPECT_GT(volts(0), 5.0);
  card([](ComediState& s) { s.open_error = EACCES; });
  const Sighting refused = driver.probe().at(1);
  EXPECT_EQ(refused.readiness, Readiness::kUnfinished);
  EXPECT_EQ(refused.place, "/dev/comedi0");
  EXPECT_EQ(refused.fact, "cannot be opened: Permission denied");
  EXPECT_THAT(refused.next, HasSubstr("usermod -aG iocard"));
  card([](ComediState& s) { s.open_error = ENOENT; });
  EXPECT_EQ(driver.probe().at(1).readiness, Readiness::kAbsent);
  options.place.library = "/nowhere/libcomedi.so.0";
  const std::vector<Sighting> none = ComediJoystickDriver(options).probe();
  ASSERT_EQ(none.size(), 1u);
  EXPECT_EQ(none[0].readiness, Readiness::kAbsent);
  EXPECT_EQ(none[0].next, "sudo apt-get install libcomedi0");
}

class JoystickTrialTest : public ComediJoystickTest {
 protected:
  TestItem item(const std::string& check) const {
    for (const TestItem& one : test->items()) {
      if (one.check == check) return one;
    }
    return {"", Verdict::kNotSeen, "", ""};
  }
  // Time runs ahead of the thread's: a turn each millisecond is `pace`, or three where it pushes.
  bool run(const std::function<bool()>& what, Nanos pace = 10 * kMillisecond) {
    for (int i = 0; i < 20'000; ++i) {
      const bool pushes = test->asks().starts_with("hold it loosely");
      if (!test->turn(now += pushes ? 3 * kMillisecond : pace)) return true;
      if (what()) return false;
      sleep_until(monotonic_now() + kMillisecond);
    }
    ADD_FAILURE() << "it does not end: " << test->asks();
    return true;
  }
  Nanos now = kSecond;
};

TEST_F(JoystickTrialTest, ItIsHomedByHandAndThenLookedAtWithAForce) {
  options.homing = StickHoming::kStops;
  auto started = ComediJoystickDriver(options).test({.alone = false, .force = 2.0});
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  EXPECT_THAT(test->asks(), HasSubstr("both of its stops, right-left"));
  int step = 0;
  EXPECT_FALSE(run([&] {
    ++step;
    turn(0, step < 30 ? -1070 : step < 60 ? 1070 : 0);
    turn(1, step < 90 ? 0 : step < 120 ? -1070 : step < 150 ? 1070 : 0);
    return step > 180;
  }));
  EXPECT_EQ(item("homing").verdict, Verdict::kOk) << item("homing").fact;
  double x = 0.0, y = 0.0;  // [counts]
  std::string asked;
  run([&] {
    if (test->asks() == "move it right") x += 2.0;
    if (test->asks() == "move it up") y += 2.0;
    // A hand of 10 counts a volt gives way.
    turn(0, static_cast<int>(x + 100.0 * volts(0)));
    turn(1, static_cast<int>(y + 100.0 * volts(1)));
    return false;
  });
  for (const char* check : {"move.right", "move.up", "force.right", "force.up"}) {
    EXPECT_EQ(item(check).verdict, Verdict::kOk) << check << ": " << item(check).fact;
  }
  EXPECT_EQ(item("move.toward").check, "");
  EXPECT_EQ(item("card").verdict, Verdict::kOk);
  EXPECT_THAT(test->block(), HasSubstr("device { kind: JOYSTICK joystick { library: "));
}

TEST_F(JoystickTrialTest, OneThatNobodyHomesIsSaid) {
  options.homing = StickHoming::kStops;
  auto started = ComediJoystickDriver(options).test({});
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  EXPECT_TRUE(run([] { return false; }, kSecond));
  EXPECT_EQ(item("homing").verdict, Verdict::kBad);
  EXPECT_THAT(item("homing").fact, HasSubstr("it went 0 by 0 mm of the 200"));
}

TEST_F(JoystickTrialTest, CalibrationFindsTheTravel) {
  options.homing = StickHoming::kStops;
  options.button_channels = {1};
  options.encoder_subdevice = {3, 3};
  auto started = ComediJoystickDriver(options).calibrate();
  ASSERT_TRUE(started) << started.message();
  opened = true;
  test = std::move(*started);
  int step = 0;
  EXPECT_TRUE(run([&] {
    ++step;
    turn(0, step < 30 ? -1100 : step < 60 ? 1100 : 0);
    turn(1, step < 90 ? 0 : step < 120 ? -1130 : step < 150 ? 1130 : 0);
    return false;
  }));
  EXPECT_EQ(item("travel.right").verdict, Verdict::kOk);
  EXPECT_THAT(item("travel.up").fact, HasSubstr("from stop to stop 213.0 mm"));
  // 2200 counts are 207.3 mm.
  EXPECT_THAT(test->block(), HasSubstr("encoder_subdevice: [3, 3] button_channel: [1] travel_mm: "
                                       "207 } }"));
}

}  // namespace
}  // namespace handrail
