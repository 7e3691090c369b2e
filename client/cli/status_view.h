// The master's status for people: one screen, grouped.
#pragma once

#include <string>

#include "proto/operator.pb.h"

namespace handrail {

std::string status_text(const pb::Status& status);

}  // namespace handrail
