// The gripper at the running programs: command line, both daemons, the outputs of the controller.
#include <gmock/gmock.h>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class GripperTest : public WholeCell {
 protected:
  void SetUp() override {
    robot_extra = "gripper { close_output: 900 open_output: 901 }";
    WholeCell::SetUp();
  }
  bool is(const std::string& state) {
    return eventually([&](const pb::Status& s) { return s.gripper() == state; });
  }
};

TEST_F(GripperTest, HoldsWhatItHoldsUntilItIsToldToLetGo) {
  ASSERT_TRUE(is("between")) << "a controller that was told nothing";
  const auto [early, told] = handrail({"robot", "grip"});
  EXPECT_EQ(early, 1);
  EXPECT_THAT(told, HasSubstr("refused: not engaged"));
  order("engage: true");
  const auto [code, answer] = handrail({"robot", "grip"});
  EXPECT_EQ(code, 0) << answer;
  EXPECT_EQ(status().gripper(), "closed");
  EXPECT_THAT(handrail({"status"}).second, HasSubstr("gripper closed"));
  // A stop, a new engagement, and other programs: nothing of it lets go.
  order("stop: true");
  order("reset: true");
  EXPECT_EQ(status().gripper(), "closed");
  order("engage: true");
  at_rest();
  EXPECT_EQ(status().gripper(), "closed");
  slave->kill();
  start_slave();
  ASSERT_TRUE(is("closed")) << "read back by a slave that was told nothing";
  master->kill();
  client.close();
  start_master();
  ASSERT_TRUE(is("closed"));
  order("engage: true");
  EXPECT_EQ(status().gripper(), "closed");
  EXPECT_EQ(handrail({"robot", "release"}).first, 0);
  EXPECT_EQ(status().gripper(), "open");
}

}  // namespace
}  // namespace handrail
