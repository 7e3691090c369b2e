// A foot switch, pressed and let go of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/evdev/evdev_file.h"
#include "devices/evdev/evdev_stream.h"
#include "devices/evdev/stop_switch.h"

namespace handrail {

// Asks for the switch to be left alone, pressed and let go of; what is not done within 15 s is not
// seen. The first key that goes down is learned.
class StopSwitchTrial final : public SelfTest {
 public:
  // Takes what was opened, and closes it. `options.key`: the one that is expected.
  StopSwitchTrial(const EvdevOpened& opened, const StopSwitchOptions& options);
  ~StopSwitchTrial() override;

  bool turn(Nanos now) override;
  std::string asks() const override;
  std::vector<TestItem> items() const override;
  // Empty until a key was seen.
  std::string block() const override;

 private:
  enum class Stage : std::uint8_t { kAlone, kPress, kLetGo, kOver };

  void go_on(Stage to, Nanos now);
  void look(Nanos now);

  EvdevOpened opened_;
  StopSwitchOptions options_;
  EvdevStream stream_;
  Stage stage_ = Stage::kAlone;
  bool started_ = false;
  Nanos began_ = 0;
  std::optional<int> key_;
  std::vector<TestItem> done_;
};

}  // namespace handrail
