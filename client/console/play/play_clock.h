// Which moment of a recording is shown at which time.
#pragma once

#include "client/console/gateway/play_orders.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// Begins paused, at the first moment. Pure: `now` is any clock that does not go back.
class PlayClock {
 public:
  // `length` >= 0: from the first moment to the last.
  explicit PlayClock(Nanos length) : length_(length) {}

  PlayState state(Nanos now) const;
  // As PlayOrders::play.
  Status take(const PlayOrder& order, Nanos now);

 private:
  Nanos length_;
  bool playing_ = false;
  Nanos from_ = 0;   // position ...
  Nanos since_ = 0;  // ... at that time
  double speed_ = 1.0;
  std::uint32_t jumps_ = 0, orders_ = 0;
};

}  // namespace handrail
