// The line between the slave and its robot's controller, made up from a seed.
#pragma once

#include <cstdint>

#include "devices/melfa/mxt_packet.h"
#include "server/base/random.h"
#include "server/lab/network/link_way.h"

namespace handrail {

// Packets to the controller, replies back, each way with its own faults. Large: keep it on the
// heap.
struct RobotLine {
  explicit RobotLine(std::uint64_t seed) : RobotLine(Random(seed)) {}

  LinkWay to_robot;
  LinkWay to_slave;

 private:
  explicit RobotLine(Random random)
      : to_robot(random.bits(), {.longest = kMxtLong}),
        to_slave(random.bits(), {.longest = kMxtLong}) {}
};

}  // namespace handrail
