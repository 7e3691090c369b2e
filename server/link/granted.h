// What a daemon's threads have of real time, as it is told to others.
#pragma once

#include "server/base/realtime.h"
#include "server/model/link_state.h"

namespace handrail {

inline RealtimeGrants granted(const RealtimeGrant& control, const RealtimeGrant& io) {
  return {control.fifo, control.memory_locked || io.memory_locked, io.fifo};
}

}  // namespace handrail
