// The master's status for people: one screen, grouped.
#pragma once

#include <string>

#include "proto/operator.pb.h"

namespace handrail {

// "the arm is 14.2 mm from the hand: ...; way out: ..."
std::string why_text(const pb::Ledger& ledger);

std::string status_text(const pb::Status& status);

}  // namespace handrail
