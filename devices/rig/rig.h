// The simulated laboratory without sockets: controller, arm, force sensor and what the tip touches,
// on one clock.
#pragma once

#include <cstdint>
#include <optional>

#include "devices/rig/controller.h"
#include "devices/rig/ft_source.h"
#include "devices/rig/switches.h"
#include "devices/rig/world/world.h"
#include "server/model/scene.h"

namespace handrail {

struct RigOptions {
  ControllerOptions controller;
  FtSourceOptions sensor;
  SwitchesOptions switches;
  std::optional<Simulate> world;  // what there is to touch; none: nothing
};

// What there is to touch from now on, and the tool that touches it.
struct Workpiece {
  std::optional<Simulate> world;  // none: nothing
  ArmGeometry geometry;
};

// Has the rig run what the scene lists and nothing else: an ideal arm and sensor where nothing is
// listed for them. A scene without a list leaves `options` alone.
void run_only_listed(const Scene& scene, RigOptions& options);

// The workpiece that a scene lists.
Workpiece workpiece_of(const Scene& scene);

enum class RigEvent : std::uint8_t {
  kNone,     // nothing is due
  kControl,  // a control cycle ran: controller().replies() are its packets
  kSensor,   // a sensor period ran: sensor().record() is its packet
};

// Same options, same datagrams at the same times: same answers, bit for bit. No allocation after
// construction; all calls are real-time safe.
//
//   while (rig.step(now) != RigEvent::kNone) { ... pass on what was sent ... }
class Rig {
 public:
  // The first cycle and the first sensor period are one period after `start`.
  Rig(const RigOptions& options, Nanos start) noexcept;

  // Runs the earliest cycle or period due at `now`, if any, at its own time. One that is more than
  // kPatience late is left out: the arm still moves by the time passed, but nobody gets a burst.
  RigEvent step(Nanos now) noexcept;
  // When the next cycle or period is due.
  Nanos next() const noexcept {
    return control_next_ < sensor_next_ ? control_next_ : sensor_next_;
  }

  // When the last control cycle ran.
  Nanos controlled_at() const noexcept { return control_next_ - control_period_; }

  Controller& controller() noexcept { return controller_; }
  const Controller& controller() const noexcept { return controller_; }
  FtSource& sensor() noexcept { return sensor_; }
  const FtSource& sensor() const noexcept { return sensor_; }
  // What the tip touches, as of the last sensor period; null when there is nothing.
  const World* world() const noexcept { return world_ ? &*world_ : nullptr; }
  // Puts another workpiece in the place of this one, new and untouched, screw and all. The joints
  // stay where they are and go where they were going; the servos, encoders and sensor are the same.
  // If the tip is inside of it, nothing changes, and what it is inside of comes back.
  std::optional<TipInside> play(const Workpiece& piece) noexcept;
  // When the world was last moved on.
  Nanos sensed_at() const noexcept { return sensor_next_ - sensor_period_; }
  // X_ST of the true tip: the world's, else the arm's.
  Pose true_tip() const noexcept { return world_ ? world_->tip() : controller_.arm().true_tip(); }
  // Cycles and periods left out so far.
  std::uint64_t skipped() const noexcept { return skipped_; }

  static constexpr Nanos kPatience = 100 * kMillisecond;

 private:
  void step_world(Nanos now) noexcept;
  void skip_late(Nanos now, Nanos period, Nanos& next) noexcept;

  Nanos control_period_;
  Nanos sensor_period_;
  Nanos control_next_;
  Nanos sensor_next_;
  std::uint64_t skipped_ = 0;
  Controller controller_;
  FtSource sensor_;
  std::optional<World> world_;
  Nanos world_at_;
};

}  // namespace handrail
