// Between the rig's thread and the one that serves its status socket: moments one way, workpieces
// the other. The rig's thread never waits, allocates or locks here.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "devices/rig/rig.h"
#include "server/base/ring.h"
#include "server/base/status.h"

namespace handrail {

// What there is at the workpiece at the end of a period of the sensor. Frame S, SI.
struct RigMoment {
  std::uint64_t number = 0;  // of the period, from 1
  std::uint64_t workpiece = 0;
  Nanos at = 0;
  Pose X_ST;                   // true
  Vec3 unbent = Vec3::Zero();  // the tip with nothing to touch
  Wrench on_tip;               // of what is touched
  bool has_socket = false;     // of the rest only then
  double turned = 0.0;         // of the screw [rad]
  double depth = 0.0;          // minus infinity: beside the mouth [m]
  double off_flats = 0.0;      // [rad]
  bool slipped = false, jammed = false;
};

class RigFeed {
 public:
  // With the workpiece that the rig starts with.
  explicit RigFeed(bool has_workpiece) : workpiece_(has_workpiece ? 1 : 0) {}

  // The rig's thread, after each period of the sensor. Real-time safe. Where nobody has heard of
  // the last second, the moment is left out, and its number is missing.
  void tell(const Rig& rig) noexcept;
  // The rig's thread: puts the workpiece in its place that waits for it. Real-time safe.
  void serve(Rig& rig) noexcept;

  // The other thread. The oldest moment not heard yet.
  bool hear(RigMoment& out) noexcept { return moments_.pop(out); }
  // The other thread: waits until the workpiece is there. What the tip would be inside of, if it is
  // not; the error: the rig's thread has not come by.
  Result<std::optional<TipInside>> play(const Workpiece& piece, Nanos patience);

 private:
  struct Wanted {
    Workpiece piece;
    std::optional<TipInside> inside;
    std::atomic<bool> served = false;
  };

  Ring<RigMoment, 1024> moments_;
  std::uint64_t number_ = 0, workpiece_;
  std::atomic<Wanted*> wanted_ = nullptr;
};

}  // namespace handrail
