// Which of the force sensors a driver looks at, in the words of `handrail devices`.
#pragma once

#include <string>

namespace handrail {

struct FtRole {
  std::string driver;                    // as it is typed; empty: that of its kind
  std::string side = "slave";            // the daemon that reads it
  std::string open = "force_sensor { ";  // its block in that daemon's file
  std::string close = " }";

  std::string daemon() const { return "handrail-" + side; }
  // What to look at when it cannot be reached.
  std::string place() const { return open + "address" + close + " in the " + side + "'s file"; }
  // The line to type that tests it, whose kind is called `usual`.
  std::string test(const char* usual) const {
    return "handrail devices test " + (driver.empty() ? std::string(usual) : driver);
  }
};

// On the handle of the master's device.
inline FtRole handle_role() { return {"handle-ft", "master", "handle_sensor { sensor { ", " } }"}; }

}  // namespace handrail
