// A force sensor on the network for `handrail devices`.
#pragma once

#include <string>
#include <utility>

#include "devices/driver.h"
#include "devices/ft_role.h"
#include "devices/net_ft/net_ft_sensor.h"

namespace handrail {

class NetFtDriver final : public Driver {
 public:
  // `taken`: another program of this computer, its daemon most likely, reads it. Most sensors
  // stream to who asked last, so that it is left alone then. Without an address there is none.
  NetFtDriver(const NetFtOptions& options, bool taken, FtRole role = {})
      : options_(options), role_(std::move(role)), taken_(taken) {}

  std::string what() const override {
    return role_.driver.empty() ? "force sensor on the network (RDT)"
                                : "force sensor on the handle (RDT, JR3, or six voltages)";
  }
  std::string daemon() const override { return role_.daemon(); }
  // Asks for the stream, and waits for a record for 0.3 s. Without one a sensor of ATI is asked for
  // its page.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // Finds the scale of a sensor of ATI on its page; OnRobot's have none.
  StartedTest calibrate() override;

 private:
  Sighting look_at_page(const std::string& place) const;

  std::string taken_text() const;
  std::string taken_next() const;
  Status none_configured() const;

  NetFtOptions options_;
  FtRole role_;
  bool taken_;
};

}  // namespace handrail
