// Does again what a recording holds: the recorded inputs through the same steps, their outputs
// beside those that were recorded.
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/base/time.h"
#include "server/lab/replay/asked_link.h"
#include "server/scene/overrides.h"

namespace handrail {

struct ReplayOptions {
  // What is asked to be otherwise; none of them: the recording as it is.
  std::vector<Override> overrides;  // of the scenes
  std::string scene;                // in place of all of them; empty: those recorded
  std::string tool;               // a tool of the scene, by name, in place of every one of its sort
  std::optional<LinkWords> link;  // another network; of a master
  // Go on from images, which are another program's memory: false for a file of whoever it may be.
  bool images = true;
  // Compare to the bit what the same build recorded; false: within kOtherBuild, as the C library's
  // functions may differ in the last bit on another kind of processor.
  bool exact = true;
  // Asked now and then; true ends the replay.
  std::function<bool()> cancelled = {};

  bool as_recorded() const { return overrides.empty() && scene.empty() && tool.empty() && !link; }
};

// The first output that is another than the recorded one.
struct ReplayDifference {
  std::uint64_t number = 0;  // of the tick or cycle
  double at = 0.0;           // since the first [s]
  std::string field;         // as in proto/record.proto, with both values
};

// What the hand felt and where it led the tip, of all ticks.
struct ReplaySummary {
  double most_force = 0.0;  // on the hand [N]
  double mean_force = 0.0;  // [N]
  double way = 0.0;         // that the command went [m]
  double most_off = 0.0;    // of the hand from its position tool [m]
  double engaged = 0.0;     // that the hand led the arm [s]
  int refused = 0;          // orders
};

struct ReplayResult {
  std::string program, version;  // that recorded
  bool same_build =
      false;  // as this program's: images can be gone on from, outputs are compared to the bit
  std::string why;              // it was begun
  double seconds = 0.0;         // from the first tick or cycle to the last
  std::uint64_t entries = 0;    // ticks or cycles
  std::uint64_t replayed = 0;   // of them, those that were done again
  std::uint64_t lost = 0;       // that the recorder had no room for
  std::uint64_t missing = 0;    // between the first and the last, those lost among them
  std::uint64_t different = 0;  // of those replayed
  std::optional<ReplayDifference> first;
  ReplaySummary was, is;  // as recorded, and as replayed; of a master
  double apart = 0.0;     // of the two commands, at most [m]
  std::string damage;     // of the file; empty: it is whole
  struct Happening {
    Nanos at = 0;  // as the ticks' times
    std::string text;
  };
  std::vector<Happening> happened;  // marks, stops, faults
  Nanos begun = 0;                  // time of the first tick or cycle
};

// Without a word of the same build the recorded numbers are met to this, relative and absolute.
inline constexpr double kOtherBuild = 1e-9;

// The error says what cannot be read or done.
Result<ReplayResult> replay(std::istream& in, const ReplayOptions& options);

}  // namespace handrail
