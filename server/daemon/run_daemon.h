// How a daemon begins and ends.
#pragma once

#include <functional>
#include <string>

#include "server/base/status.h"
#include "server/daemon/errand.h"

namespace handrail {

// The line on standard output that tells who started a daemon that it is ready. Nobody waits until
// it is taken: a stopped terminal or a full pipe keeps only a thread of its own.
class Announcement {
 public:
  // `line` without its end. Once.
  void make(const std::string& line);

 private:
  Errand<Status> errand_;
};

// For a start that fails: says why on standard error; the exit code of a bad argument,
// configuration or address. Signals that end the program are taken from here on: whoever started it
// may not read.
int fail_start(const std::string& program, const std::string& why);

// `work` is all that a daemon does, its log included; its exit code. What the system refuses there
// (descriptors, memory, threads) is said on standard error, and the code is 1; memory also where
// a library cannot hand the refusal on. To be called last in
// main: may end the process itself.
int run_daemon(const std::string& program, const std::function<int()>& work);

}  // namespace handrail
