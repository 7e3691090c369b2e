// A force sensor on the network for `handrail devices`.
#pragma once

#include <string>

#include "devices/driver.h"
#include "devices/net_ft/net_ft_sensor.h"

namespace handrail {

class NetFtDriver final : public Driver {
 public:
  // `taken`: another program of this computer, a slave most likely, reads it. Most sensors stream
  // to who asked last, so that it is left alone then.
  NetFtDriver(const NetFtOptions& options, bool taken) : options_(options), taken_(taken) {}

  std::string what() const override { return "force sensor on the network (RDT)"; }
  std::string daemon() const override { return "handrail-slave"; }
  // Asks for the stream, and waits for a record for 0.3 s. Without one a sensor of ATI is asked for
  // its page.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // Finds the scale of a sensor of ATI on its page; OnRobot's have none.
  StartedTest calibrate() override;

 private:
  Sighting look_at_page(const std::string& place) const;

  NetFtOptions options_;
  bool taken_;
};

}  // namespace handrail
