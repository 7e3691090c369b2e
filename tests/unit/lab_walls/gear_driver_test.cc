#include "server/lab/walls/gear_driver.h"

#include <gmock/gmock.h>

#include <functional>

#include "server/scene/scene_library.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;

// A lever that is always where the hand wants it, in a gate whose locks may fail.
class GearDriverTest : public ::testing::Test {
 protected:
  GearDriverTest() : scene(*SceneLibrary().load("gearshift")), gate(*GearGate::of(scene)) {}

  // Whether the lock of `gear` closes the `time`th time it is entered, from 1.
  using Closes = std::function<bool(std::size_t gear, int time)>;

  // The gears entered, in their order, until the driver is done.
  std::vector<std::string> drive(const Closes& closes) {
    GearDriver driver(gate, 1.0);
    std::vector<std::string> entered;
    std::vector<int> times(gate.places().size());
    std::size_t in = times.size();  // gear
    WallTick tick;
    for (; !driver.done() && tick.t < 600.0; tick.t += kBenchTick) {
      driver.drive(tick);
      tick.hand = driver.lets_go() ? gate.neutral() : driver.p();
      for (std::size_t i = 0; i < times.size(); ++i) {
        if (in != i && (tick.hand - gate.places()[i]).norm() < 1e-3) {
          in = i;
          ++times[i];
          entered.push_back(gate.names()[i]);
        }
      }
      if (in < times.size() && (tick.hand - gate.places()[in]).norm() > 0.01) in = times.size();
      tick.effects.locked = in < times.size() && closes(in, times[in]);
      released_in_gear |= driver.lets_go() && tick.effects.locked;
    }
    EXPECT_TRUE(driver.done());
    return entered;
  }

  Scene scene;
  GearGate gate;
  bool released_in_gear = false;
};

TEST_F(GearDriverTest, EntersEveryGearOnceWhereLocksClose) {
  EXPECT_THAT(drive([](std::size_t, int) { return true; }),
              ElementsAre("1", "2", "3", "4", "5", "R"));
  EXPECT_FALSE(released_in_gear);
}

TEST_F(GearDriverTest, TriesAgainUntilTheGearIsIn) {
  EXPECT_THAT(drive([](std::size_t gear, int time) { return gear != 1 || time == 3; }),
              ElementsAre("1", "2", "2", "2", "3", "4", "5", "R"));
}

TEST_F(GearDriverTest, GivesUpOnALockThatNeverCloses) {
  const std::vector<std::string> entered = drive([](std::size_t gear, int) { return gear != 5; });
  EXPECT_EQ(entered.size(), 5u + GearDriver::kTries);
  EXPECT_EQ(entered.back(), "R");
}

TEST_F(GearDriverTest, LetsGoInTheEndOfALeverThatDoesNotComeAlong) {
  GearDriver driver(gate, 1.0);
  WallTick tick;
  tick.hand = gate.places().back();
  tick.effects.locked = true;
  double t = 0.0;
  for (; !driver.done() && t < 60.0; tick.t = t += kBenchTick) driver.drive(tick);
  EXPECT_TRUE(driver.done());
}

}  // namespace
}  // namespace handrail
