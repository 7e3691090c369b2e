// Foxglove's WebSocket protocol: its texts and its bytes, without sockets.
//
// Facts from its specification (github.com/foxglove/ws-protocol, docs/spec.md): text frames are
// JSON with `op`; a binary frame to the viewer begins with the opcode 1 and has, little-endian, the
// subscription (u32), nanoseconds since 1970 (u64) and the message.
#pragma once

#include <google/protobuf/descriptor.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/viewer.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// What a viewer may offer, and we say back, the preferred one first.
inline constexpr std::array<const char*, 2> kViewerProtocols = {"foxglove.sdk.v1",
                                                                "foxglove.websocket.v1"};

enum class ViewerLevel : std::uint8_t { kInfo = 0, kWarning = 1, kError = 2 };

std::string server_info_text(const std::string& version, const std::string& session);
std::string status_text(ViewerLevel level, const std::string& message);
std::string advertise_text(const pb::ViewerAdvertise& channels);

// `topic` with messages of that type, as an advertise has it.
pb::ViewerChannel viewer_channel(std::uint32_t id, const std::string& topic,
                                 const google::protobuf::Descriptor& type);

// Of one message for one subscription. `calendar`: since 1970-01-01 UTC.
std::string data_frame(std::uint32_t subscription, Nanos calendar, std::string_view message);

// The error is one line of plain text. Fields and ops that we do not know are no error.
Result<pb::FromViewer> viewer_frame(std::string_view json);

}  // namespace handrail
