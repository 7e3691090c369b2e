// The master's status for people: one screen, grouped.
#pragma once

#include <climits>
#include <string>

#include "proto/operator.pb.h"

namespace handrail {

// "the arm is 14.2 mm from the hand: ...; way out: ..."
std::string why_text(const pb::Ledger& ledger);

// Rows of a terminal of 80 x 24, one of them for the cursor.
inline constexpr long kTerminalRows = 23;

// 80 columns wide. Of more rows than `most_rows`, 23 or more, the least important ones are left
// out, and " ..." says where.
std::string status_text(const pb::Status& status, long most_rows = LONG_MAX);

}  // namespace handrail
