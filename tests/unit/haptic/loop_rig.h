// Both steps with a constant delay between them, a tick a millisecond, for tests.
#pragma once

#include <deque>
#include <vector>

#include "tests/unit/follow/follow_rig.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail::test {

// The slave has a cycle every seven ticks.
struct LoopRig {
  static constexpr int kThere = 20, kBack = 10;  // ticks of transit
  HapticRig master;
  FollowRig slave;
  std::vector<MasterState> sent;
  std::deque<SlaveState> back;

  LoopRig() {
    master.play_slave = false;
    slave.cycle();
    master.in.slave = slave.out.link;
  }
  void tick() {
    master.tick();
    sent.push_back(master.out.link);
    const std::size_t now = sent.size();
    if (now % 7 == 0 && now > kThere) {
      slave.in.master_known = true;
      slave.in.master_age = 0;
      slave.in.master_sequence = now - kThere;
      slave.in.master = sent[now - kThere];
      slave.cycle();
    }
    back.push_back(slave.out.link);
    if (back.size() > kBack) {
      master.in.slave = back.front();
      back.pop_front();
    }
  }
  Vec3 stage(MotionStage s) const { return master.out.motion.off_S.col(static_cast<int>(s)); }
};

}  // namespace handrail::test
