// Foxglove's WebSocket protocol: its texts and its bytes, without sockets.
//
// Facts from its specification (github.com/foxglove/ws-protocol, docs/spec.md): text frames are
// JSON with `op`; a binary frame to the viewer begins with the opcode 1 and has, little-endian, the
// subscription (u32), nanoseconds since 1970 (u64) and the message; with 2, the time that is shown
// (u64). Of a recording, from the sources of Foxglove's SDK (github.com/foxglove/foxglove-sdk,
// rust/foxglove/src/protocol/common: client/playback_control_request.rs, server/playback_state.rs,
// server/server_info.rs), as the specification does not have it: a request from the viewer begins
// with 3 and has play 0 or pause 1 (u8), speed (f32), whether it seeks (u8), to when (u64), the
// length of its id (u32) and that; the answer begins with 5 and has playing 0, paused 1, buffering
// 2 or ended 3 (u8), now (u64), speed (f32), whether it came by a seek (u8), and the id in the same
// way, without one where nobody has asked.
#pragma once

#include <google/protobuf/descriptor.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "client/console/gateway/play_orders.h"
#include "proto/viewer.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// What a viewer may offer, and we say back, the preferred one first.
inline constexpr std::array<const char*, 2> kViewerProtocols = {"foxglove.sdk.v1",
                                                                "foxglove.websocket.v1"};

enum class ViewerLevel : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

// From when to when a recording goes. Since 1970-01-01 UTC.
struct ViewerRange {
  Nanos begins = 0, ends = 0;
};
// `range`: of a recording, which a viewer may play.
std::string server_info_text(const std::string& version, const std::string& session,
                             const std::optional<ViewerRange>& range = {});
std::string status_text(ViewerLevel level, const std::string& message);
std::string advertise_text(const pb::ViewerAdvertise& channels);

// `topic` with messages of that type, as an advertise has it.
pb::ViewerChannel viewer_channel(std::uint32_t id, const std::string& topic,
                                 const google::protobuf::Descriptor& type);

// Of one message for one subscription. `calendar`: since 1970-01-01 UTC.
std::string data_frame(std::uint32_t subscription, Nanos calendar, std::string_view message);

// The time that is shown.
std::string time_frame(Nanos calendar);

// What a viewer asks of a recording.
struct ViewerPlay {
  bool playing = false;
  float speed = 1.0f;
  std::optional<Nanos> seek;  // since 1970-01-01 UTC
  std::string id;             // comes back in the answer
};
// The frame with its opcode. The error says what is not as it should be.
Result<ViewerPlay> viewer_play(std::string_view frame);
std::string playback_frame(const PlayState& state, Nanos calendar, bool by_seek,
                           const std::string& id);

// The error is one line of plain text. Fields and ops that we do not know are no error.
Result<pb::FromViewer> viewer_frame(std::string_view json);

}  // namespace handrail
