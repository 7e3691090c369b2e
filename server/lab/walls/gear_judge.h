// Which gears a lever has been in: of the lab's runs and of people's.
#pragma once

#include <string>
#include <vector>

#include "server/lab/walls/gearshift_run.h"

namespace handrail {

// Of a tick it takes time, hand and the lock.
class GearJudge {
 public:
  // `gate` outlives it.
  explicit GearJudge(const GearGate& gate) : gate_(gate) {}

  void see(const WallTick& tick);

  // The lever has come to rest in neutral and has not left it since.
  bool rests_in_neutral() const noexcept { return rested_; }
  // N if it began there, then each gear when its lock has closed.
  const std::vector<std::string>& so_far() const noexcept { return visited_; }
  // The same; and N after a gear, at final rest.
  std::vector<std::string> visited() const;

 private:
  const GearGate& gate_;
  RestWatch rest_;
  std::vector<std::string> visited_;
  int locked_ = -1;  // the gear that is; -1: none
  bool seen_ = false, rested_ = false;
};

}  // namespace handrail
