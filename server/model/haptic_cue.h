// What a hand is to feel beside force.
#pragma once

#include <cstdint>

namespace handrail {

enum class Felt : std::uint8_t {
  kNothing,
  kContact,     // the arm touches something
  kHold,        // the link pauses
  kLost,        // the link is lost, somebody has to reset
  kLimit,       // reach, range or speed keeps the arm back
  kSingularity  // a singular pose does
};

struct HapticCue {
  Felt what = Felt::kNothing;
  double strength = 0.0;  // now, 0 to 1; pauses between two trembles are 0
  friend bool operator==(const HapticCue&, const HapticCue&) = default;
};

}  // namespace handrail
