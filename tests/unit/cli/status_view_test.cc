#include "client/cli/status_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace handrail {
namespace {

using testing::HasSubstr;

pb::Status engaged() {
  pb::Status s;
  s.set_state("engaged");
  s.set_reason("joint speed limit: following more slowly");
  s.set_slave_state("engaged");
  s.set_packet_age_ms(0.61);
  s.set_loss_share(0.013);
  s.set_round_trip_ms(-1);
  s.mutable_loop_lateness_us()->set_p999(41.25);
  s.mutable_position_tool()->set_kind("line");
  s.mutable_position_tool()->set_id(3);
  s.mutable_position_tool()->set_deviation_mm(0.4213);
  s.mutable_tool_force()->set_magnitude_n(0.337);
  for (const double x : {350.0, -150.5, 429.0}) s.mutable_tip()->add_position_mm(x);
  return s;
}

TEST(StatusView, ShowsStateReasonLinkLoopToolsAndForces) {
  const std::string text = status_text(engaged());
  EXPECT_THAT(text, HasSubstr("session    engaged   reason: joint speed limit"));
  EXPECT_THAT(text, HasSubstr("age 0.61 ms   loss 1.3 %   round trip none yet"));
  EXPECT_THAT(text, HasSubstr("p99.9 41.2"));
  EXPECT_THAT(text, HasSubstr("position: line #3, 0.421 mm off"));
  EXPECT_THAT(text, HasSubstr("orientation: none"));
  EXPECT_THAT(text, HasSubstr("tool 0.337   spring 0.000   limits 0.000   device 0.000"));
  EXPECT_THAT(text, HasSubstr("350.000   -150.500    429.000"));
}

TEST(StatusView, FitsOneScreen) {
  const std::string text = status_text(engaged());
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 24);
}

TEST(StatusView, NamesEverySectionThatDiffers) {
  pb::Status s = engaged();
  s.add_hash_mismatch("mapping: master 3f2a, slave 91bc");
  EXPECT_THAT(status_text(s), HasSubstr("differs: mapping: master 3f2a, slave 91bc"));
}

TEST(StatusView, ShowsTheWallsOfASceneThatHasThem) {
  pb::Status s = engaged();
  EXPECT_THAT(status_text(s), testing::Not(HasSubstr("walls")));
  s.mutable_walls()->set_stage(1);
  EXPECT_THAT(status_text(s), HasSubstr("walls      stage 1   free\n"));
  s.mutable_walls()->set_stage_name("open");
  EXPECT_THAT(status_text(s), HasSubstr("walls      stage 1 'open'   free\n"));
  s.mutable_walls()->clear_stage_name();
  s.mutable_walls()->set_touching(true);
  s.mutable_walls()->set_penetration_mm(0.417);
  s.mutable_walls()->set_locked(true);
  EXPECT_THAT(status_text(s), HasSubstr("walls      stage 1   0.42 mm in a wall   locked\n"));
}

TEST(StatusView, ShowsAnEmptyStatusWithoutInventingValues) {
  const std::string text = status_text(pb::Status());
  EXPECT_THAT(text, HasSubstr("no sensor"));
  EXPECT_THAT(text, HasSubstr("tip           -"));
}

}  // namespace
}  // namespace handrail
