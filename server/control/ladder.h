// What the link's two ages and its quality allow.
#pragma once

#include "server/base/link_state.h"

namespace handrail {

// Constant while a scene is loaded.
struct LadderSettings {
  Nanos good_for = 0;  // the link is GOOD both ways for so long before an engagement
  Nanos warn_loop = 100 * kMillisecond;  // older loops are said
  Nanos fade_loop = kForever;            // older ones take the force away; the arm goes on
};

}  // namespace handrail
