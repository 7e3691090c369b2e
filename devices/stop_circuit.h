// What can stop the arm on the slave's own computer.
#pragma once

namespace handrail {

// A circuit that is closed while all is well. Called from the robot thread only.
class StopCircuit {
 public:
  virtual ~StopCircuit() = default;
  // True while the arm must not move, and where that is not known. Opening for less than a call's
  // time is told once. Real-time safe.
  virtual bool is_open() noexcept = 0;
};

}  // namespace handrail
