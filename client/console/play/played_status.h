// What the master's status would have been at a moment of a recording.
#pragma once

#include "proto/operator.pb.h"
#include "server/base/status.h"
#include "server/model/scene.h"
#include "server/record/recording_reader.h"

namespace handrail {

// As the master makes it, of all that a tick or a cycle holds; `scene`: that it names, null where
// it cannot be read. What no recording has is absent: counters, lease, peer, what an engage asks
// of the link, the way out as orders. Of a slave's recording also the hand and the forces on it.
// Orientations between hand and command, and how the force was shared, are as in take_all(). The
// error names the field of the message that is at fault.
Result<pb::Status> played_status(const pb::RecordedStart& start, bool of_master,
                                 const RecordingMoment& moment, const Scene* scene);

// The number by which the moment names its scene.
std::uint32_t scene_number(bool of_master, const RecordingMoment& moment);

}  // namespace handrail
