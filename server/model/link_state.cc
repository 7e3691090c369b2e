#include "server/model/link_state.h"

namespace handrail {

const char* name_of(SessionState state) noexcept {
  switch (state) {
    case SessionState::kOff: return "off";
    case SessionState::kAligning: return "aligning";
    case SessionState::kEngaged: return "engaged";
    case SessionState::kClutched: return "clutched";
    case SessionState::kHold: return "hold";
    case SessionState::kFault: return "fault";
    case SessionState::kHoming: return "homing";
    case SessionState::kCount: break;
  }
  return "unknown";
}

const char* name_of(LinkGrade grade) noexcept {
  switch (grade) {
    case LinkGrade::kPoor: return "POOR";
    case LinkGrade::kFair: return "FAIR";
    case LinkGrade::kGood: return "GOOD";
    case LinkGrade::kExcellent: return "EXCELLENT";
  }
  return "unknown";
}

const char* name_of(Desired desired) noexcept {
  switch (desired) {
    case Desired::kOff: return "off";
    case Desired::kEngaged: return "engaged";
    case Desired::kClutched: return "clutched";
    case Desired::kCount: break;
  }
  return "unknown";
}

}  // namespace handrail
