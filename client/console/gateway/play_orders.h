// What pages and viewers ask of a recording that is shown to them.
#pragma once

#include <cstdint>
#include <optional>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// Speeds at which a recording can be played: seconds of it in a second.
inline constexpr double kSlowestPlay = 0.1, kFastestPlay = 10.0;

// Where the player stands.
struct PlayState {
  enum class Is : std::uint8_t { kPlaying, kPaused, kEnded };
  Is is = Is::kPaused;
  Nanos position = 0;        // since the recording's first moment
  double speed = 1.0;        // seconds of it in a second
  std::uint32_t jumps = 0;   // to elsewhere, so far
  std::uint32_t orders = 0;  // taken so far: of two states the older has fewer, or as many
};

// What is absent stays as it is.
struct PlayOrder {
  std::optional<bool> playing = {};    // at the end: from the beginning on
  std::optional<Nanos> position = {};  // beyond an end: that end
  std::optional<double> speed = {};
};

class PlayOrders {
 public:
  virtual ~PlayOrders() = default;
  // How it stands from then on. The error names value and what was expected; nothing is changed.
  // From any thread; nobody waits.
  virtual Result<PlayState> play(const PlayOrder& order) = 0;
};

}  // namespace handrail
