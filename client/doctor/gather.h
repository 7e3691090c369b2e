// Reads what the judges need to know, and changes nothing. None of it waits for long.
#pragma once

#include "client/doctor/facts.h"
#include "server/keys/key_folder.h"

namespace handrail {

KeyFacts key_facts(const std::string& folder);

// The daemons of this user, by their names in /proc.
std::vector<LocalProgram> local_programs();

// How things stand, but for what takes time to see.
MachineFacts machine_facts();

// The way that a datagram to "192.0.2.7:47002" or "[2001:db8::7]:47002" would take; none is sent.
RouteFacts route_facts(const std::string& to);

// Asks the master at `place` for its status for `seconds`, 50 times a second, as one who watches
// it; and sees in `machine` what takes time away meanwhile, with or without a master. Ends early
// when `cancelled` says so.
MasterFacts watch_master(const MasterPlace& place, double seconds, bool (*cancelled)(),
                         MachineFacts& machine);

}  // namespace handrail
