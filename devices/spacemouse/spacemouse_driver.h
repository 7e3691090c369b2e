// The SpaceMouse for `handrail devices`.
#pragma once

#include <string>

#include "devices/driver.h"
#include "devices/input/usb_scan.h"
#include "devices/spacemouse/spacemouse_device.h"

namespace handrail {

// What its block says besides the kind: the socket, where one is configured, and full_counts.
std::string spacemouse_block(const SpaceMouseOptions& options);

class SpaceMouseDriver final : public Driver {
 public:
  explicit SpaceMouseDriver(const SpaceMouseOptions& options, std::string usb_folder = kUsbFolder)
      : options_(options), usb_folder_(std::move(usb_folder)) {}

  std::string what() const override { return "SpaceMouse of 3Dconnexion, through spacenavd"; }
  std::string daemon() const override { return "handrail-master"; }
  // Looks for a cap on USB and for spacenavd.
  std::vector<Sighting> probe() override;
  StartedTest test(const TestWishes& wishes) override;
  // Finds full_counts.
  StartedTest calibrate() override;

 private:
  SpaceMouseOptions options_;
  std::string usb_folder_;
};

}  // namespace handrail
