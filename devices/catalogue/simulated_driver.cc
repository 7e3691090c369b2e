#include "devices/catalogue/simulated_driver.h"

#include <utility>

#include "devices/self_test/hand_test.h"

namespace handrail {

std::string SimulatedDriver::block() const {
  const std::string recording =
      options_.recording_path.empty() ? "" : " recording: \"" + options_.recording_path + "\"";
  return "device { kind: " + kind_ + recording + " }";
}

std::vector<Sighting> SimulatedDriver::probe() {
  const auto made = make_haptic_device(options_);
  if (made) return {{"", Readiness::kReady, "simulated: there is nothing to plug in", ""}};
  return {{"", Readiness::kUnfinished, made.message(), block() + " in the master's file"}};
}

StartedTest SimulatedDriver::test(const TestWishes& wishes) {
  auto made = make_haptic_device(options_);
  if (!made) return made.status();
  if (const Status opened = (*made)->open(); !opened) return opened;
  return StartedTest(std::make_unique<HandTest>(std::move(*made), wishes, block()));
}

StartedTest SimulatedDriver::calibrate() {
  return Status::error(what_ + ": simulated, there is nothing to calibrate");
}

}  // namespace handrail
