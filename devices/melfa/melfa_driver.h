// A MELFA controller for `handrail devices`.
#pragma once

#include <optional>
#include <string>

#include "devices/driver.h"
#include "devices/melfa/melfa_robot.h"

namespace handrail {

class MelfaDriver final : public Driver {
 public:
  // `taken`: another program of this computer, a slave most likely, speaks with the controller. A
  // question of somebody else's could end its session, so that nothing is sent then.
  MelfaDriver(const MelfaOptions& options, bool taken) : options_(options), taken_(taken) {}

  std::string what() const override { return "Mitsubishi MELFA controller (MXT)"; }
  std::string daemon() const override { return "handrail-slave"; }
  // One packet that moves nothing, of each of the two sizes until one is answered, 0.3 s each. It
  // ends no program of the controller's. Without an answer the controller's own switches are asked
  // why, a second at most.
  std::vector<Sighting> probe() override;
  // Opens a session as the slave does, and ends it: the controller's program then goes on.
  StartedTest test(const TestWishes& wishes) override;
  // Finds packet_bytes.
  StartedTest calibrate() override;

 private:
  std::string place() const;
  std::optional<std::size_t> answers(std::size_t size) const;
  std::vector<TestItem> switches() const;

  MelfaOptions options_;
  bool taken_;
};

}  // namespace handrail
