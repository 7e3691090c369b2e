// A side as the emulator sees it: its end of the wire, and what its programs do.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "tests/emulator/side_process.h"

namespace handrail::emulator {

// A program of a side.
struct SideProgram {
  pid_t pid = 0;               // as the emulator's namespace numbers it; 0: not started yet
  bool ended = false;          // or never started
  int status = 0;              // as of wait, when it has ended
  std::string problem;         // why it never started
  bool good() const;           // it has ended by itself with 0
  std::string ending() const;  // "exit 0", "signal 9", "runs", "cannot run: ..."
};

// Namespaces of its own with one TUN device. Whatever becomes of the emulator, everything in them
// ends with it. Made by a process with a single thread.
class SideHost {
 public:
  SideHost() = default;
  ~SideHost();
  SideHost(const SideHost&) = delete;
  SideHost& operator=(const SideHost&) = delete;

  // The error says what this machine does not allow.
  Status start(const SideSetup& setup);

  int wire() const { return wire_; }  // packets, one a read or write; does not block
  int news() const {
    return socket_;
  }  // has something to read when take_news() has something to do

  // Starts a program by its words; `name` is to be new. `output`: a descriptor for what it prints,
  // -1: the emulator's own.
  Status run(const std::string& name, const std::vector<std::string>& words, int output = -1);
  void signal(const std::string& name, int number);
  // One piece of news; false: the side is gone.
  bool take_news();

  const std::map<std::string, SideProgram>& programs() const { return programs_; }
  // Packets that its programs sent faster than the emulator took them.
  std::uint64_t missed() const;

 private:
  int socket_ = -1, wire_ = -1;
  pid_t pid_ = 0;
  std::map<std::string, SideProgram> programs_;
};

}  // namespace handrail::emulator
