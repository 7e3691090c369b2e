#include "server/slave/connection_watch.h"

#include <gtest/gtest.h>

#include <vector>

namespace handrail {
namespace {

class ConnectionWatchTest : public ::testing::Test {
 protected:
  void look(bool connected, bool lost, const std::string& problem, Reason fault = Reason::kNone) {
    if (const auto line = watch.step(connected, lost, problem, fault)) {
      lines.push_back((line->bad ? "bad: " : "good: ") + line->text);
    }
  }
  ConnectionWatch watch{"the arm"};
  std::vector<std::string> lines;
};

TEST_F(ConnectionWatchTest, AProblemIsALineWhenItBeginsAndOneWhenItEnds) {
  look(false, false, "");
  for (int i = 0; i < 100; ++i) look(false, false, "no answer");
  for (int i = 0; i < 100; ++i) look(true, false, "");
  EXPECT_EQ(lines, (std::vector<std::string>{"bad: no answer; trying again",
                                             "good: connected to the arm"}));
}

TEST_F(ConnectionWatchTest, NumbersThatChangeMakeNoOtherProblem) {
  for (int i = 0; i < 100; ++i) {
    look(false, false, std::to_string(17 + i) + " answers, none a joint reply");
    look(false, false, "J3 is measured at " + std::to_string(0.1 * (i - 50)) + " deg");
  }
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "bad: 17 answers, none a joint reply; trying again");
  look(true, false, "");
  look(false, false, "18 answers, none a joint reply");
  EXPECT_EQ(lines.size(), 4u) << "after a connection it begins anew";
}

TEST_F(ConnectionWatchTest, ALostControllerIsOneLineAndIsNotSaidToBeTriedAgainByItself) {
  look(true, false, "");
  lines.clear();
  look(false, true, "", Reason::kRobotLost);
  EXPECT_TRUE(lines.empty()) << "the session's line says so";
  look(false, true, "no answer", Reason::kRobotLost);
  EXPECT_EQ(lines, std::vector<std::string>{"bad: no answer; a reset tries to connect again"});
}

TEST_F(ConnectionWatchTest, AControllerLostWhileTheSessionIsInAnotherFaultIsSaid) {
  look(true, false, "", Reason::kStopRequested);
  lines.clear();
  look(false, true, "", Reason::kStopRequested);
  look(false, true, "", Reason::kStopRequested);
  EXPECT_EQ(lines, std::vector<std::string>{std::string("bad: ") + describe(Reason::kRobotLost) +
                                            "; a reset tries to connect again"});
}

}  // namespace
}  // namespace handrail
