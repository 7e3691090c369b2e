// Scenes of walls, made ready for the haptic loop.
#pragma once

#include <deque>
#include <memory>

#include "devices/haptic_device.h"
#include "proto/config.pb.h"
#include "server/haptic/haptic_run.h"
#include "server/master/mailboxes.h"
#include "server/model/scene.h"

namespace handrail {

// The walls of `scene`, which has some, with their proxy and the scene's effects, for a device.
// `governor`: what the device cannot hold is rendered less stiff, and no energy is made. May block
// and allocate.
std::unique_ptr<WallRun> make_wall_run(const Scene& scene, const HapticCapabilities& device,
                                       bool governor = false);

// Keeps what the haptic loop may still use, so that it never has to free anything: the loop takes a
// scene within a tick, and the desk has at most one under way.
class WallRuns {
 public:
  // Null for a scene without walls. Valid until three more were made.
  WallRun* make(const Scene& scene, const HapticCapabilities& device, bool governor = false);

 private:
  std::deque<std::unique_ptr<WallRun>> runs_;
};

// What the loop runs with a scene, but for its number: settings as the master's configuration has
// them, and the walls, kept in `runs`.
LoopScene loop_scene_of(const Scene& scene, const HapticCapabilities& device,
                        const pb::MasterConfig& config, WallRuns& runs);

// What is told of the walls after a tick; not present in a scene without. Real-time safe.
WallReport wall_report(const HapticRun& run) noexcept;

// A device that is simulated has the scene's effects, and begins where its walls leave it free.
// Real-time safe.
void place_device(const LoopScene& scene, HapticDevice& device) noexcept;

}  // namespace handrail
