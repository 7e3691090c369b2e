// Another network than the recorded one, under a recorded master.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "server/base/random.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/haptic/haptic_step.h"

namespace handrail {

struct LinkWords {
  Nanos delay = 0;    // one way, on top of the recorded one
  Nanos jitter = 0;   // at most so much more, uniformly
  double loss = 0.0;  // share of the slave's datagrams
};

// "delay=50,jitter=20,loss=10": ms, ms, %; what is not named is 0. The error says what is expected.
Result<LinkWords> link_words(const std::string& text);

// What the master would have heard of the recorded slave: each of its states later by the way there
// and back, as its answer to a command that comes later would be, or never. A datagram that an
// other has overtaken is not heard. The slave's own doing stays as it was recorded.
class AskedLink {
 public:
  explicit AskedLink(const LinkWords& words) : words_(words) {}

  // Of the recorded tick at `now`; `anew`: a state came that was not there the tick before.
  void apply(Nanos now, bool anew, HapticInput& in);

 private:
  struct Heard {
    Nanos at = 0;
    std::uint64_t number = 0;
    SlaveState state;
  };
  LinkWords words_;
  Random random_{1};
  std::deque<Heard> under_way_;
  std::uint64_t number_ = 0, newest_ = 0;
  Nanos heard_at_ = -kForever;
  SlaveState state_;
};

}  // namespace handrail
