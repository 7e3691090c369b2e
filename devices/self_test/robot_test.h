// Any arm's controller, looked at without a motion.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/robot.h"

namespace handrail {

// Three seconds in which the controller is asked where it holds the arm, and told nothing: how many
// cycles it answers, how long they are, where the joints are and whether they stand still. Moves
// nothing. The session ends with the test, and the controller's program goes on.
class RobotTest final : public SelfTest {
 public:
  // `robot` is connected, and `first` what it said. `block`: what block() is to say. `known`: what
  // was found out before.
  RobotTest(std::unique_ptr<Robot> robot, const RobotReply& first, std::string block,
            std::vector<TestItem> known = {});
  ~RobotTest() override { robot_->end(); }

  Nanos period() const override { return 0; }  // a turn is a cycle of the controller
  bool turn(Nanos now) override;
  std::string asks() const override { return {}; }
  std::vector<TestItem> items() const override;
  std::string block() const override { return block_; }

 private:
  std::unique_ptr<Robot> robot_;
  std::string block_;
  std::vector<TestItem> known_;
  RobotReply reply_;
  bool started_ = false, lost_ = false;
  Nanos began_ = 0, last_ = 0;
  std::uint64_t replies_ = 0, silences_ = 0, rejected_ = 0;
  JointVector least_, most_;  // measured [rad]
};

}  // namespace handrail
