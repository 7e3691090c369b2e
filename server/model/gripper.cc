#include "server/model/gripper.h"

namespace handrail {

const char* name_of(GripperState state) noexcept {
  switch (state) {
    case GripperState::kNone: return "none";
    case GripperState::kClosed: return "closed";
    case GripperState::kOpen: return "open";
    case GripperState::kBetween: return "between";
    case GripperState::kCount: break;
  }
  return "unknown";
}

}  // namespace handrail
