// Facts in, findings out: no clock, no file, no socket.
#pragma once

#include "client/doctor/facts.h"
#include "client/doctor/finding.h"

namespace handrail {

// All that follows, in the order in which it is read.
Findings judge(const DoctorFacts& facts);

// The key of this user, and who is trusted.
void judge_keys(const DoctorFacts& facts, Findings& out);
// Which programs run, and whether they are of one make.
void judge_programs(const DoctorFacts& facts, Findings& out);
// Whether there is a session and what the link does, beside what an engage asks of it.
void judge_link(const DoctorFacts& facts, Findings& out);
// The way that the datagrams take.
void judge_route(const DoctorFacts& facts, Findings& out);
// The session, its scene, and what holds the arm.
void judge_session(const DoctorFacts& facts, Findings& out);
// The devices of the files that were given, and what master and slave say of theirs.
void judge_devices(const DoctorFacts& facts, Findings& out);
// Real time, here and for the daemons.
void judge_realtime(const DoctorFacts& facts, Findings& out);
// What takes time from programs, and the clocks.
void judge_machine(const DoctorFacts& facts, Findings& out);

}  // namespace handrail
