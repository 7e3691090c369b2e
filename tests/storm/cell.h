// Rig, slave and master as real programs on free ports, that can be paused, ended and started anew.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "tests/storm/sequence.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace handrail::storm {

class Cell {
 public:
  // `as_shipped`: with the daemons' own scene and simulated hand, not those of a storm.
  explicit Cell(const Sequence& sequence, bool as_shipped = false);

  // Standard error of a program that is started from here on; -1: with what it prints.
  void log_to(Who who, int fd) { logs_[static_cast<std::size_t>(who)] = fd; }
  // Where the slave is; and where masters that are started from here on find it.
  std::string link_socket() const { return folder_.path() + "/link.sock"; }
  void lead_link_through(const std::string& path) { link_through_ = path; }

  // Starts a program and waits until it says that it is ready. The error has what it printed.
  Status start(Who who);
  // SIGSTOP and SIGCONT.
  void pause(Who who);
  void resume(Who who);
  void send(Who who, int signal) { child(who).send(signal); }
  // Waits for the end of a program that was started and told to end: its code, or minus the signal.
  int wait_for_end(Who who);
  bool running(Who who) { return program(who).child && child(who).running(); }
  bool paused(Who who) const { return program(who).paused; }
  std::string output(Who who) const;
  pid_t pid(Who who) const { return program(who).child->pid(); }
  int code(Who who) const { return program(who).child->code(); }

  std::string socket() const { return folder_.path() + "/operator/operator.sock"; }
  // Of every start of the rig, oldest first.
  const std::vector<std::string>& taps() const { return taps_; }
  const TempFolder& folder() const { return folder_; }

 private:
  struct Program {
    std::unique_ptr<Child> child;
    bool paused = false;
  };
  Program& program(Who who) { return programs_[static_cast<std::size_t>(who)]; }
  const Program& program(Who who) const { return programs_[static_cast<std::size_t>(who)]; }
  Child& child(Who who) { return *program(who).child; }
  std::string config(Who who);

  Sequence sequence_;
  bool as_shipped_;
  TempFolder folder_;
  std::array<Program, 3> programs_;
  std::array<int, 3> logs_{-1, -1, -1};
  std::vector<std::string> taps_;
  int starts_ = 0;
  int robot_port_ = 0, sensor_port_ = 0;
  std::string link_through_;  // empty: nothing is between
};

}  // namespace handrail::storm
