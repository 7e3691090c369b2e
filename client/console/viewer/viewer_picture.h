// What the master says, as messages that Foxglove and Lichtblick draw. Metres and radians.
//
// Frames, each with what it hangs on:
//   world         the root
//   base          world. S, the arm's base; scenes of an arm
//   link_1 .. 6   base, and one on the other. After joints 1 to 6, as in pb::ArmShape; 4 to 6 are
//                 at the wrist's centre
//   flange        link_6
//   tip, ghost    base. The tip measured, and where the hand wants it
//   device        world. M, the haptic device's base, turned as the scene maps it; the arm's base
//                 and the device have no place to each other, so its origin is the world's
//   hand          device. Where the device is
//   walls         device. Of the map, in the stage that is on; scenes of walls
#pragma once

#include <string>

#include "client/console/scene/map_cells.h"
#include "proto/console.pb.h"
#include "proto/foxglove.pb.h"
#include "proto/operator.pb.h"
#include "proto/viewer.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// `calendar` is since 1970-01-01 UTC. What a status does not have is left out.
foxglove::FrameTransforms frame_transforms(const pb::Status& status, const pb::SceneNews& scene,
                                           Nanos calendar);
// Measured, J1 to J6.
foxglove::JointStates joint_states(const pb::Status& status, Nanos calendar);
// In `base`. Without a pose where `pose` has none.
foxglove::PoseInFrame pose_in_frame(const pb::PoseMm& pose, Nanos calendar);

// Tools where they constrain, and forces: of an arm's scene at the tip, of walls' at the hand.
foxglove::SceneUpdate marks(const pb::Status& status, const pb::SceneNews& scene, Nanos calendar);
// Takes away all that a channel has drawn.
foxglove::SceneUpdate nothing_drawn(Nanos calendar);
// What does not change with a status: arm, work pieces, goals. Takes away what was there before.
foxglove::SceneUpdate work_cell(const pb::SceneNews& scene, Nanos calendar);
// In `walls`. Where the scene has none one cell that nobody sees, in `world`: it takes the place of
// the map that was there.
foxglove::Grid map_grid(const MapCells& cells, Nanos calendar);

// What the master is held by, or that it does not answer: one line that changes when its reason
// does, and not with each number.
foxglove::Log log_line(const Result<pb::Reply>& reply, Nanos calendar);

// What events tell of.
struct ViewerFacts {
  bool answers = false;  // the master
  std::string state, reason, holder, scene;
};
ViewerFacts facts_of(const Result<pb::Reply>& reply);
// From what was to what is, at most one of each kind.
std::vector<pb::ViewerEvent> events_between(const ViewerFacts& was, const ViewerFacts& is,
                                            Nanos calendar);

}  // namespace handrail
