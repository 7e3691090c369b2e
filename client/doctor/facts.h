// What `handrail doctor` knows before it judges: read from this computer, and from the master.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/api/master_place.h"
#include "devices/driver.h"
#include "proto/operator.pb.h"
#include "server/keys/trust_list.h"

namespace handrail {

// The folder of keys, as it is on the disk.
struct KeyFacts {
  std::string folder;
  std::string key_path, trusted_path;
  bool has_key = false;
  // Modes as chmod has them, "0644"; empty: not there.
  std::string key_mode, trusted_mode;
  bool key_is_private = true;            // nobody but its owner may read or change it
  bool trusted_is_ours_to_write = true;  // nobody but its owner may change it
  std::optional<Trusted> own;            // our key, its name and roles; none: own_problem says why
  std::string own_problem;
  double own_age_s = 0.0;            // since the key was made [s]
  std::optional<TrustList> trusted;  // none: trusted_problem says why
  std::string trusted_problem;
};

// A daemon of this user that runs on this computer.
struct LocalProgram {
  std::string name;            // "handrail-master", "handrail-slave"
  int process = 0;             // its number
  bool calls_network = false;  // it was started with --link
  int fifo_threads = 0;        // of its threads, those with SCHED_FIFO
  bool memory_locked = false;
};

// What the system lets this shell's programs have, and what takes time from them.
struct MachineFacts {
  std::string user;         // name
  bool may_fifo = false;    // SCHED_FIFO at the highest priority that the daemons ask for
  bool may_lock = false;    // all of the memory
  long most_priority = 0;   // `ulimit -r`; -1: unlimited
  long most_locked_kb = 0;  // `ulimit -l`; -1: unlimited
  std::vector<std::string> governors;  // of the processors, each kind once; empty: none is known
  double stolen_share = -1.0;          // of one processor's time, by the hypervisor; -1: not known
  int pauses = 0;                      // of 20 ms and more in which this program did not run
  double longest_pause_ms = 0.0;
  double watched_s = 0.0;                // for how long
  std::string clock_source;              // the kernel's; empty: not known
  std::optional<bool> calendar_is_kept;  // by a time server; none: not known
};

enum class Tunnel : std::uint8_t { kNone, kWireGuard, kTailscale };

// The way to the other end of the link, as the kernel has it.
struct RouteFacts {
  std::string to;         // address and port
  std::string problem;    // why there is none
  std::string interface;  // through which it goes
  int mtu = 0;            // what goes through without being cut in pieces [bytes]; 0: not known
  bool v6 = false;
  Tunnel tunnel = Tunnel::kNone;
};

// What the master said in a row of answers; empty: there is none.
struct MasterFacts {
  MasterPlace place;                                 // where it was looked for
  std::string problem;                               // why there is none
  bool absent = false;                               // nobody serves the socket
  std::optional<pb::Status> status;                  // the newest
  std::vector<double> round_trips_ms, loop_ages_ms;  // measured; as they came
  double watched_s = 0.0;
};

// A device that the daemons' files name, as its driver sees it.
struct DeviceFacts {
  std::string name;  // of the driver
  std::vector<Sighting> seen;
};

struct DoctorFacts {
  std::string version;  // of this program
  int wire_version = 0;
  std::string realtime_line;  // what root types to grant this user real time
  KeyFacts keys;
  std::vector<LocalProgram> programs;
  MachineFacts machine;
  MasterFacts master;
  std::vector<DeviceFacts> devices;  // none where no file was given
  std::string devices_problem;       // why a file cannot be read; empty: it can
  std::optional<RouteFacts> route;   // none: the link stays on this computer, or is not known
  std::size_t largest_datagram = 0;  // of the encrypted link, without UDP and IP [bytes]
  std::size_t largest_handshake = 0;
};

}  // namespace handrail
