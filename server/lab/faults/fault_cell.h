// The cell of a run of a fault row, and its recordings.
#pragma once

#include <cstdint>
#include <memory>
#include <sstream>
#include <string>

#include "server/base/time.h"
#include "server/lab/cell/cell.h"
#include "server/lab/replay/cell_recording.h"
#include "server/model/scene.h"

namespace handrail {

struct FaultOptions {
  Nanos master_clock = 0;  // before the run's
  Nanos slave_clock = 0;
  Presence presence = Presence::kNone;
  Nanos fade_loop = 600 * kMillisecond;  // an older loop takes the force away
  // A surface of 57 N/mm, with what gives way in the arm, kFaultGap under the tip where it starts;
  // approached slowly enough for 200 N. The hand stands, but for `layers().hand`.
  bool contact = false;
  bool queues = false;       // the controller works off one packet a cycle, the rest wait
  bool short_form = false;   // 64-byte packets to the controller and back
  bool brisk = false;        // the hand turns up to 0.3 rad, twice as often
  bool gentle = false;       // the hand goes a tenth of its way
  bool sensor_noise = true;  // in contact
};

// Of a run in contact: down to the surface [m], and out of it.
inline constexpr double kFaultGap = 0.004;
const Vec3& fault_normal();

// As a scene's file has it.
Scene fault_scene(const FaultOptions& fault);

std::unique_ptr<Cell> fault_cell(std::uint64_t seed, const FaultOptions& fault);

// What both programs of the cell would have recorded, in memory.
class FaultRecording {
 public:
  // Before the cell's first tick.
  FaultRecording(Cell& cell, const FaultOptions& fault);
  // After every tick.
  void pull() { recording_.pull(); }

  struct Again {
    std::uint64_t replayed = 0;   // ticks and cycles
    std::uint64_t different = 0;  // of them
    std::string problem;          // what could not be done again, and why; empty: nothing
  };
  // Both sides' steps again, from what was recorded. Ends the recording.
  Again again();

 private:
  std::ostringstream master_, slave_;
  CellRecording recording_;
};

}  // namespace handrail
