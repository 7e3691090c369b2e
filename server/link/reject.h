// Why a datagram was dropped. A peer's bytes are never fatal: each cause is counted, nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace handrail {

enum class Reject : std::uint8_t {
  kNone = 0,  // accepted
  // Frame
  kSize,     // shorter than a frame or longer than a datagram may be
  kMagic,    // not one of ours
  kVersion,  // another version of the wire contract
  kKind,     // the wrong direction, such as our own bytes reflected
  kLength,   // truncated, or bytes after the end
  kChecksum,
  // Content
  kProtobuf,      // the payload is not a protobuf message
  kUnknownField,  // a field or an enum value this version does not know
  kMissingField,  // a field is absent or has the wrong number of elements
  kHeader,        // session or sequence 0, a negative time, an echo of nothing
  kEnum,          // a code out of range
  kNotFinite,
  kRotation,  // a quaternion off unit length by over 1e-6
  kRange,     // a position of 10 m or more from the base, a negative span
  kTool,      // a tool that contradicts itself or its hash
  kSurface,   // a surface whose normal is no unit vector, or that is too far, too soft or too stiff
  kScene,     // a scene name with other than letters, digits, - and _, or too long
  // Order
  kDuplicate,       // a sequence already accepted
  kStale,           // older than the newest accepted
  kSessionBusy,     // a new session while the present one has been heard within 200 ms
  kSessionRetired,  // a session that another one has replaced
  kRefused,         // no state: the slave says that another master leads it
  // Transport
  kSender,      // from another user, or one who is not the peer
  kAfterStall,  // waited in our own queue while we did not run
  kCount
};

inline constexpr std::size_t kRejectCauses = static_cast<std::size_t>(Reject::kCount);

// How often each cause has occurred; index = static_cast<std::size_t>(cause).
using RejectCounts = std::array<std::uint64_t, kRejectCauses>;

// One short English fragment, static storage. Never null.
const char* describe(Reject cause) noexcept;

// "checksum mismatch 3, duplicate 20": the causes that have occurred, but for kNone; empty: none
// has. Allocates.
std::string causes_text(const RejectCounts& counts);

}  // namespace handrail
