// A page's cursor on its way to the device.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/base/units.h"
#include "tests/unit/master/desk_bench.h"
#include "tests/unit/master/loop_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class CursorDeskTest : public DeskBench {
 protected:
  CursorDeskTest() : DeskBench(true) { tick(); }
  void take_lease() { ASSERT_EQ(text(ask("lease { act: TAKE }")), "done: "); }
  // A cursor at so many millimetres to the right.
  std::string point(int sequence, double x, const std::string& more = "held: true") {
    const std::string place = "position_mm: [" + std::to_string(x) + ", 0, 0]";
    return text(ask("cursor { sequence: " + std::to_string(sequence) + " " + place + more + "}"));
  }
  CursorSample newest() {
    CursorSample out;
    (void)boxes.cursor.take(out);
    return out;
  }
  pb::CursorStatus shown_cursor() { return (*ask("status: true"))->status().haptic().cursor(); }
};

TEST_F(CursorDeskTest, GoesToTheLoopAtOnceAndTheStatusShowsIt) {
  take_lease();
  EXPECT_EQ(point(7, 20.0, " rotation_deg: [0, 0, 90] clutch: true held: true"), "done: ");
  const CursorSample cursor = newest();
  EXPECT_EQ(cursor.sequence, 7u);
  EXPECT_NEAR(cursor.X_MC.p.x(), 0.020, 1e-12);
  EXPECT_NEAR(angle_between(cursor.X_MC.q, rotation_exp(Vec3(0, 0, 90 * kDeg))), 0.0, 1e-9);
  EXPECT_EQ(cursor.buttons, 5u) << "clutch and dead-man";
  EXPECT_EQ(cursor.at, now);
  tick(150 * kMillisecond);
  const pb::CursorStatus shown = shown_cursor();
  EXPECT_EQ(shown.sequence(), 7u);
  EXPECT_NEAR(shown.age_ms(), 150.0, 1e-9);
  EXPECT_TRUE(shown.held());
  EXPECT_NEAR(shown.position_mm(0), 20.0, 1e-9);
  tick(100 * kMillisecond);
  EXPECT_FALSE(shown_cursor().held()) << "older than 200 ms";
}

TEST_F(CursorDeskTest, IsRefusedWithoutTheLease) {
  EXPECT_THAT(point(1, 10.0), HasSubstr("refused: cursor: nobody has the lease"));
  ASSERT_EQ(text(ask("as: 'ann' lease { act: TAKE }")), "done: ");
  EXPECT_THAT(point(2, 10.0), HasSubstr("ann"));
  EXPECT_EQ(newest().sequence, 0u) << "nothing has reached the loop";
}

TEST_F(CursorDeskTest, LeavesOneOutThatIsOlderThanTheNewest) {
  take_lease();
  EXPECT_EQ(point(5, 10.0), "done: ");
  EXPECT_THAT(point(5, 20.0), HasSubstr("number 5 is not above 5"));
  EXPECT_THAT(point(4, 20.0), HasSubstr("number 4 is not above 5"));
  EXPECT_NEAR(newest().X_MC.p.x(), 0.010, 1e-12);
  tick(201 * kMillisecond);
  EXPECT_EQ(point(1, 30.0), "done: ") << "a page that is loaded again counts from 1";
}

TEST_F(CursorDeskTest, SaysWhatIsWrongWithAPlace) {
  take_lease();
  EXPECT_THAT(text(ask("cursor { sequence: 1 held: true }")), HasSubstr("expected three numbers"));
  EXPECT_THAT(text(ask("cursor { sequence: 1 position_mm: [1, 2] }")), HasSubstr("three numbers"));
  EXPECT_THAT(point(1, 1001.0), HasSubstr("1001 mm"));
  EXPECT_THAT(text(ask("cursor { sequence: 1 position_mm: [nan, 0, 0] }")), HasSubstr("refused"));
  EXPECT_THAT(point(1, 0.0, " rotation_deg: [0, 181, 0]"), HasSubstr("181 deg"));
  EXPECT_EQ(newest().sequence, 0u);
}

class NoCursorDeskTest : public DeskBench {};

TEST_F(NoCursorDeskTest, IsRefusedByADeviceThatAHandHolds) {
  tick();
  ASSERT_EQ(text(ask("lease { act: TAKE }")), "done: ");
  EXPECT_THAT(text(ask("cursor { sequence: 1 position_mm: [0, 0, 0] held: true }")),
              HasSubstr("the device is 'its device', expected the kind PAGE"));
  EXPECT_FALSE((*ask("status: true"))->status().haptic().has_cursor());
}

class CursorLoopTest : public LoopBench {};

TEST_F(CursorLoopTest, TheNewestCursorReachesTheDeviceBeforeItsReading) {
  CursorSample cursor;
  for (const std::uint64_t sequence : {3u, 4u}) {
    cursor.sequence = sequence;
    boxes.cursor.publish(cursor);
  }
  tick();
  EXPECT_EQ(device.led_to.sequence, 4u);
}

}  // namespace
}  // namespace handrail
