// The 2-DOF joystick, over a stand-in for libcomedi.
#include "devices/comedi/comedi_joystick.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <cmath>
#include <utility>

#include "devices/comedi/comedi_joystick_driver.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/comedi/joystick_bench.h"

namespace handrail {
namespace {

using test::ComediState;
using ::testing::HasSubstr;

using ComediJoystickTest = test::JoystickBench;

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
  EXPECT_TRUE(comes_to({0.0942478, -0.0188496, 0.0}));
  options.counts_per_turn = {-10000.0, 20000.0};
  turn(0, 0);
  turn(1, 0);
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  turn(0, 1000);
  turn(1, -200);
  EXPECT_TRUE(comes_to({-0.0942478, -0.0094248, 0.0}));
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
  ASSERT_TRUE(becomes([&] { return (void)read(), device->tick().seen[1] > 0.0942; }));
  turn(1, 1080);  // the last count reaches the stop
  ASSERT_TRUE(valid());
  EXPECT_NEAR(read().X_MH.p.x(), 655 * kJoystickResolution, 1e-6);
  EXPECT_NEAR(read().X_MH.p.y(), 1040 * kJoystickResolution, 1e-6);
  EXPECT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
}

// 220 mm are the most that there is room for, and from -1060 to 1400 counts are 232.
TEST_F(ComediJoystickTest, OneThatGoesFurtherThanItCanLetsGoSaysSoAndIsHomedAnew) {
  options.homing = StickHoming::kStops;
  ASSERT_NO_FATAL_FAILURE(open());
  EXPECT_FALSE(read().valid);
  EXPECT_THAT(trouble(), HasSubstr("not homed: move it to its four stops"));
  for (const int motor : {0, 1}) {
    turn(motor, -1060);
    turn(motor, 1060);
  }
  ASSERT_TRUE(valid());
  ASSERT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
  turn(1, 1400);
  ASSERT_TRUE(valid(false));
  EXPECT_EQ(volts(0), 0.0);
  EXPECT_THAT(trouble(), HasSubstr("from stop to stop are 200; counts_per_turn, travel_mm, or"));
  ASSERT_TRUE(becomes([&] { return (void)read(), device->tick().there; }));
  EXPECT_THAT(trouble(), HasSubstr("it went 200 by 22"));
  EXPECT_THAT(trouble(), HasSubstr("; then move it to its four stops"));
  // Homed anew it goes on, without the master ending.
  turn(0, -1060);
  turn(1, 1400 - 2120);
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->tick().losses, 1u);
  EXPECT_EQ(text_of(device->tick().lost_for), "");
  EXPECT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
}

// 300 counts are 28.3 mm. A card whose readings come 2.8 ms apart takes them for a hand's way, as
// it must: then they are taken back as a hand does, and leap again.
TEST_F(ComediJoystickTest, CountsThatLeapLoseTheCard) {
  for (const int motor : {0, 1}) {
    for (const int way : {300, -300}) {
      options.homing = motor == 0 ? StickHoming::kStops : StickHoming::kCentre;
      options.reopen_pause = 200 * kMillisecond;
      turn(motor, 0);
      ASSERT_NO_FATAL_FAILURE(open());
      ASSERT_TRUE(becomes([&] { return leap_is_seen(motor, way); }));
      EXPECT_FALSE(read().valid);
      const std::string said = trouble();
      EXPECT_THAT(said, HasSubstr(motor == 0 ? "its encoder right-left leapt by "
                                             : "its encoder up-down leapt by "));
      EXPECT_THAT(said, HasSubstr(way > 0 ? "by 300 counts, 28.3 mm, in "
                                          : "by -300 counts, -28.3 mm, in "));
      EXPECT_THAT(said, HasSubstr("m/s, and at most 10 are a hand's; look at its cable"));
    }
  }
}

TEST_F(ComediJoystickTest, AThreadThatWasLateTakesNoWayForALeap) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  // The card answers late: its lock is held for so long as a hand takes for the way.
  card([&](ComediState& s) {
    sleep_until(monotonic_now() + 60 * kMillisecond);
    s.subdevices[3].values[0] = 300;
  });
  ASSERT_TRUE(becomes([&] { return read().X_MH.p.x() > 0.028; }));
  EXPECT_EQ(device->tick().losses, 0u);
}

// A coarse encoder's only count is 9.4 mm.
TEST_F(ComediJoystickTest, ASingleCountIsNoLeap) {
  options.counts_per_turn = {100.0, 100.0};
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  for (int i = 1; i <= 20; ++i) {
    leap(0, i % 2);
    sleep_until(monotonic_now() + 5 * kMillisecond);
  }
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->tick().losses, 0u);
}

// What the card was told last stays at its outputs: nobody else may write to it.
TEST_F(ComediJoystickTest, AReadingThatBlocksIsSaidAndTheVoltageStaysMeanwhile) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  ASSERT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
  card([&](ComediState& s) {
    for (int i = 0; i < 300; ++i) {
      device->write({Vec3(3.0, 0.0, 0.0), Vec3::Zero()});
      (void)read();
      sleep_until(monotonic_now() + kMillisecond);
    }
    EXPECT_FALSE(read().valid);
    EXPECT_EQ(trouble(), "its thread has not come back from the card; sudo dmesg | grep comedi");
    EXPECT_GT(s.subdevices[1].values[0], 36000u);  // 1.18 V
  });
  ASSERT_TRUE(valid());
  EXPECT_EQ(device->tick().losses, 0u);
}

TEST_F(ComediJoystickTest, ACardThatTakesNoTorqueKeepsItsVoltageUntilItTakesSomeAgain) {
  options.reopen_pause = kMillisecond;
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  ASSERT_TRUE(pushes(0, 1.18421, Vec3(3.0, 0.0, 0.0)));
  card([](ComediState& s) { s.write_error = EIO; });
  ASSERT_TRUE(valid(false));
  EXPECT_EQ(trouble(), "it takes no torque: Input/output error; sudo dmesg | grep comedi");
  sleep_until(monotonic_now() + 100 * kMillisecond);
  EXPECT_GT(volts(0), 0.5) << "as it was";
  card([](ComediState& s) { s.write_error = 0; });
  ASSERT_TRUE(valid());
  EXPECT_EQ(volts(0), 0.0);
}

TEST_F(ComediJoystickTest, ACardThatIsGoneIsNamed) {
  ASSERT_NO_FATAL_FAILURE(open());
  ASSERT_TRUE(valid());
  card([](ComediState& s) { s.open_error = ENOENT, s.read_error = ENODEV; });
  ASSERT_TRUE(valid(false));
  EXPECT_EQ(trouble(), "its encoders cannot be read: No such device; sudo dmesg | grep comedi");
  card([](ComediState& s) { s.open_error = s.read_error = 0; });
  ASSERT_TRUE(valid());
  card([](ComediState& s) { s.open_error = ENOENT, s.write_error = EIO; });
  ASSERT_TRUE(valid(false));
  EXPECT_EQ(trouble(), "it takes no torque: Input/output error; sudo dmesg | grep comedi");
  card([](ComediState& s) { s.open_error = s.write_error = 0; });
  ASSERT_TRUE(valid());
  device->close();
  EXPECT_EQ(trouble(), "it is not open");
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

}  // namespace
}  // namespace handrail
