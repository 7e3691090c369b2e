// The demo's drive against a scripted master.
#include "client/cli/demo_drive.h"

#include <gmock/gmock.h>

#include "tests/loopback/operator_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// Engages at once and ends the session by itself whenever the hand is sent somewhere.
class FaithlessMaster : public OperatorHandler {
 public:
  void handle(const pb::Request& request, std::function<void(pb::Reply)> reply,
              StillWaits /*waits*/) override {
    if (request.has_engage()) state_ = "engaged";
    if (request.has_reset()) state_ = "off";
    if (request.has_hand() && !request.hand().home()) {
      ++moves;
      state_ = "fault";
    }
    pb::Reply answer;
    answer.set_done(true);
    if (request.has_status()) {
      answer.mutable_status()->set_state(state_);
      answer.mutable_status()->mutable_ledger()->set_sentence("the link was lost");
    }
    reply(answer);
  }
  bool may_drive(const std::optional<std::string>&) const override { return true; }

  std::atomic<int> moves{0};

 private:
  std::string state_ = "off";
};

class DemoDrive : public ::testing::Test {
 protected:
  void SetUp() override { catch_interrupts(); }  // as the command does: one before is none

  TempFolder folder;
  const std::string path = folder.path() + "/operator.sock";
  const BenchOf<FaithlessMaster> bench{path};
  DemoDriver driver{path, ""};
};

TEST_F(DemoDrive, AMoveIsRepeatedTenTimesAndNoMore) {
  ASSERT_TRUE(driver.engage());
  std::vector<std::string> said;
  driver.begin_move();
  do {
    driver.move(Vec3(10, 0, 0), Vec3::Zero());
  } while (driver.lost() &&
           driver.recover(Pose(), [&said](const std::string& line) { said.push_back(line); }));
  EXPECT_FALSE(driver.ok());
  EXPECT_EQ(driver.code(), kExitRefused);
  EXPECT_EQ(driver.problem(), "the session ended again and again: the link was lost");
  EXPECT_EQ(bench.master.moves, 11);
  EXPECT_EQ(said.size(), 10u);
  EXPECT_THAT(said.front(), HasSubstr("the session ended: the link was lost; resetting, engaging, "
                                      "repeating this move"));
}

TEST_F(DemoDrive, TheNextMoveHasTenRepeatsOfItsOwn) {
  for (int move = 0; move < 2; ++move) {
    driver.begin_move();
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(driver.engage());
      driver.move(Vec3(10, 0, 0), Vec3::Zero());
      ASSERT_TRUE(driver.lost());
      ASSERT_EQ(driver.code(), kExitDone);
    }
  }
  EXPECT_EQ(driver.losses(), 20);
}

}  // namespace
}  // namespace handrail
