// A page's cursor as the hand: it leads the arm, feels walls, and lets go when it is gone.
#include <gmock/gmock.h>

#include <cmath>

#include "server/model/reason.h"
#include "tests/loopback/console/console_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class ConsoleHandTest : public ConsoleCell {
 protected:
  void SetUp() override {
    device_kind = "kind: PAGE";
    WholeCell::SetUp();
    start_console();
    page = open_page();
    ASSERT_TRUE(page->ask(lead("TAKE"), 1, kPatience).value().done());
  }
  // Holds the cursor there until `condition` of a status, or in vain.
  template <typename F>
  bool hold_until(double x, double y, bool held, F condition) {
    for (const Nanos give_up = monotonic_now() + kPatience; monotonic_now() < give_up;) {
      if (!page->say(hand(++sequence, x, y, held))) return false;
      const auto frame = page->next_frame(kSecond);
      if (!frame) return false;
      if (frame->status().has_status() && condition(frame->status().status())) return true;
    }
    return false;
  }
  void engage() {
    ASSERT_TRUE(
        hold_until(0, 0, true, [](const pb::Status& s) { return s.haptic().cursor().held(); }));
    ASSERT_TRUE(page->say(request(7, R"({"engage": true})")));
    ASSERT_TRUE(hold_until(0, 0, true, [](const pb::Status& s) { return s.state() == "engaged"; }));
  }

  std::unique_ptr<WebPage> page;
  std::uint64_t sequence = 0;
};

TEST_F(ConsoleHandTest, LeadsTheArmAndTheArmHoldsWhenThePageIsGone) {
  engage();
  const Vec3 before = mm(status().tip());
  // 20 mm to the right at the device: as the scene maps it, scaled.
  EXPECT_TRUE(hold_until(20, 0, true, [&](const pb::Status& s) {
    return (mm(s.tip()) - before).norm() > 30.0 && std::abs(mm(s.hand()).x() - 20.0) < 1.0;
  }));
  const Nanos gone = monotonic_now();
  page->vanish();
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.state() == "clutched"; }));
  EXPECT_LT(monotonic_now() - gone, kSecond);
  const pb::Status held = status();
  EXPECT_EQ(held.reason(), describe(Reason::kPresence));
  EXPECT_FALSE(held.haptic().cursor().held());
  EXPECT_TRUE(
      eventually([](const pb::Status& s) { return s.device_force().magnitude_n() == 0.0; }));
  EXPECT_TRUE(reaches("off")) << "and after 2 s the engagement ends";
}

TEST_F(ConsoleHandTest, LetsGoWithoutACursorThoughThePageIsOpen) {
  engage();
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.state() == "clutched"; }));
  EXPECT_TRUE(hold_until(0, 0, true, [](const pb::Status& s) { return s.state() == "engaged"; }))
      << "held again within 2 s, it goes on";
  ASSERT_TRUE(hold_until(0, 0, false, [](const pb::Status& s) { return s.state() == "clutched"; }));
}

TEST_F(ConsoleHandTest, FeelsAWallAsWhatKeepsTheDeviceFromTheCursor) {
  const auto loaded = page->ask(request(3, R"({"scene_load": "gearshift"})"), 3, kPatience);
  ASSERT_TRUE(loaded && loaded->done()) << (loaded ? loaded->reason() : "no reply");
  const auto scene = page->wait_for(kPatience, [](const pb::ToPage& f) {
    return f.has_scene() && f.scene().name() == "gearshift";
  });
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->scene().kind(), pb::SceneNews::WALLS);
  EXPECT_EQ(web_get(port, scene->scene().map().picture(), own_headers()).body.substr(1, 3), "PNG");
  // Sideways out of the lever's aisle, into the wall.
  const auto felt = [](const pb::Status& s) {
    return s.walls().touching() && s.walls().penetration_mm() > 0.3 &&
           std::hypot(s.walls().force_n(0), s.walls().force_n(1)) > 2.0;
  };
  ASSERT_TRUE(hold_until(60, 60, true, felt));
  const pb::Status s = status();
  const Vec3 cursor(s.haptic().cursor().position_mm(0), s.haptic().cursor().position_mm(1), 0);
  EXPECT_GT((mm(s.hand()) - cursor).norm(), 5.0) << "it is kept from the cursor";
  page->vanish();
  EXPECT_TRUE(eventually([](const pb::Status& now) {
    return now.device_force().magnitude_n() == 0.0 && !now.haptic().cursor().held();
  }));
}

TEST_F(ConsoleHandTest, ACursorOfWhoDoesNotLeadMovesNothing) {
  const auto other = open_page();
  ASSERT_TRUE(other->say(hand(1, 50, 0, true)));
  ASSERT_TRUE(hold_until(
      5, 0, true, [](const pb::Status& s) { return std::abs(mm(s.hand()).x() - 5.0) < 0.5; }));
  EXPECT_NEAR(status().haptic().cursor().position_mm(0), 5.0, 1e-9);
  const std::string text = "cursor { sequence: 1 position_mm: [50, 0, 0] held: true }";
  EXPECT_THAT(refusal("as: 'ann' " + text), HasSubstr("console"));
}

}  // namespace
}  // namespace handrail
