#include "server/link/reject.h"

namespace handrail {

const char* describe(Reject cause) noexcept {
  switch (cause) {
    case Reject::kNone: return "accepted";
    case Reject::kSize: return "size out of range";
    case Reject::kMagic: return "not a Handrail datagram";
    case Reject::kVersion: return "another protocol version";
    case Reject::kKind: return "wrong direction";
    case Reject::kLength: return "truncated or trailing bytes";
    case Reject::kChecksum: return "checksum mismatch";
    case Reject::kProtobuf: return "malformed payload";
    case Reject::kUnknownField: return "unknown field or enum value";
    case Reject::kMissingField: return "missing field or wrong element count";
    case Reject::kHeader: return "invalid session, sequence or time";
    case Reject::kEnum: return "code out of range";
    case Reject::kNotFinite: return "value not finite";
    case Reject::kRotation: return "quaternion not of unit length";
    case Reject::kRange: return "value out of range";
    case Reject::kTool: return "inconsistent tool";
    case Reject::kSurface: return "surface out of range";
    case Reject::kScene: return "invalid scene name";
    case Reject::kDuplicate: return "duplicate";
    case Reject::kStale: return "older than the newest accepted";
    case Reject::kSessionBusy: return "another session is alive";
    case Reject::kSessionRetired: return "session already replaced";
    case Reject::kRefused: return "the slave is led by another master";
    case Reject::kSender: return "unknown sender";
    case Reject::kAfterStall: return "queued while this program stalled";
    case Reject::kCount: break;
  }
  return "unknown cause";
}

std::string causes_text(const RejectCounts& counts) {
  std::string out;
  for (std::size_t i = 1; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    if (!out.empty()) out += ", ";
    out += std::string(describe(static_cast<Reject>(i))) + " " + std::to_string(counts[i]);
  }
  return out;
}

}  // namespace handrail
