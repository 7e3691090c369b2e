// Findings as people and programs read them.
#pragma once

#include <string>

#include "client/doctor/finding.h"
#include "proto/doctor.pb.h"

namespace handrail {

// A finding a paragraph, what is a problem in capitals; the last line counts them.
std::string doctor_text(const Findings& findings);

pb::DoctorReport doctor_report(const Findings& findings);

}  // namespace handrail
