// The slave's part of the ledger, filled in passing by its step. Real-time safe.
#pragma once

#include "server/model/link_state.h"

namespace handrail {

// `stage` moved the commanded tip by `off` [m], because of `why`.
inline void put_stage(FollowLedger& ledger, FollowStage stage, const Vec3& off,
                      Reason why) noexcept {
  ledger.off_S.col(static_cast<int>(stage)) = off.cast<float>();
  ledger.why[static_cast<std::size_t>(stage)] = why;
}

}  // namespace handrail
