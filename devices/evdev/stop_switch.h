// A foot switch or a key as the slave's stop circuit.
#pragma once

#include <optional>
#include <string>

#include "devices/evdev/evdev_file.h"
#include "devices/evdev/evdev_reader.h"
#include "devices/stop_circuit.h"

namespace handrail {

struct StopSwitchOptions {
  std::string path;        // such as /dev/input/by-id/...-event-kbd
  std::optional<int> key;  // the kernel's code, 1 to KEY_MAX; none: any key of the device
  Nanos reopen_pause = kReopenPause;  // from a millisecond on
};

// Open while the key is down, while the device is unplugged, and while that is not known, as after
// events that the kernel had no room for. The device is grabbed: what it types reaches nobody else.
// Not a safety device: kernel, USB and this program are in between.
class StopSwitch final : public StopCircuit {
 public:
  explicit StopSwitch(const StopSwitchOptions& options, EvdevKernel& kernel = evdev_kernel());
  ~StopSwitch() override { stop(); }

  // Opens the device. The error names it, and what it has not. Blocks shortly.
  Status start();
  // It is open from then on. Twice is fine.
  void stop() noexcept;
  bool is_open() noexcept override;

 private:
  Result<EvdevOpened> open_device() const;

  StopSwitchOptions options_;
  EvdevKernel& kernel_;
  EvdevReader reader_;
  bool started_ = false;
};

}  // namespace handrail
