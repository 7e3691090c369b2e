// Debian's spacenavd with a Magellan at it, in a folder of its own.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/child.h"
#include "tests/support/magellan.h"
#include "tests/support/temp_folder.h"

namespace handrail::test {

class RealSpacenavd {
 public:
  static constexpr char kProgram[] = "/usr/bin/spacenavd";
  static constexpr char kMissing[] = "/usr/bin/spacenavd is not installed: client/install --tests";

  static bool installed() { return ::access(kProgram, X_OK) == 0; }

  // Starts it, and waits until it has asked the Magellan what it is. False: it did not, and log()
  // says what it did.
  bool start(Nanos patience) {
    if (magellan.path().empty()) return false;
    // Not as a daemon it has its socket below the folder in which it was started.
    const std::string& at = folder_.path();
    if (::mkdir((at + "/run").c_str(), 0700) != 0) return false;
    folder_.write("rc", "serial = " + magellan.path() + "\n");
    daemon_ = std::make_unique<Child>(
        "/bin/sh",
        std::vector<std::string>{"-c", "cd '" + at + "' && exec " + kProgram + " -d -v -c '" + at +
                                           "/rc' -l '" + at + "/log'"},
        at + "/output");
    for (const Nanos until = monotonic_now() + patience; monotonic_now() < until;) {
      if (magellan.answer() && ::access(socket().c_str(), F_OK) == 0) {
        // It listens a moment after its socket is there, and a client that only tries, and leaves,
        // takes the device with it.
        sleep_until(monotonic_now() + 100 * kMillisecond);
        return true;
      }
      if (!daemon_->running()) return false;
      sleep_until(monotonic_now() + 5 * kMillisecond);
    }
    return false;
  }
  std::string socket() const { return folder_.path() + "/run/spnav.sock"; }
  bool running() { return daemon_ != nullptr && daemon_->running(); }
  void kill() { daemon_.reset(); }
  std::string log() {
    return "heard: " + magellan.heard() + "\n" + (daemon_ ? daemon_->output() : "");
  }

  Magellan magellan;

 private:
  TempFolder folder_;
  std::unique_ptr<Child> daemon_;
};

}  // namespace handrail::test
