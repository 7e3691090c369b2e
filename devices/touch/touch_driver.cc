#include "devices/touch/touch_driver.h"

#include <unistd.h>

#include <filesystem>
#include <memory>

#include "devices/touch/touch_trial.h"

namespace handrail {
namespace {

namespace fs = std::filesystem;

// 3D Systems' number, which some units have as the product's (public notes of owners).
constexpr std::uint16_t kThreeDSystems = 0x2988;

bool is_touch(const UsbDevice& d) {
  return d.vendor == kThreeDSystems || (d.vendor == 0x0301 && d.product == kThreeDSystems);
}

std::string touch_block(const TouchOptions& o) {
  std::string inner;
  if (!o.name.empty()) inner += "name: \"" + o.name + "\" ";
  if (o.library != TouchOptions().library) inner += "library: \"" + o.library + "\" ";
  return "device { kind: TOUCH" + (inner.empty() ? "" : " touch { " + inner + "}") + " }";
}

}  // namespace

Sighting TouchDriver::on_usb() const {
  for (const UsbDevice& device : usb_devices(usb_folder_)) {
    if (!is_touch(device)) continue;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(dev_folder_, error)) {
      const std::string path = entry.path().string();
      if (!entry.path().filename().string().starts_with("ttyACM")) continue;
      if (::access(path.c_str(), R_OK | W_OK) == 0) continue;
      return {"USB", Readiness::kUnfinished,
              usb_text(device) + ", but this user may not use " + path,
              "sudo usermod -aG dialout $USER, then log in anew"};
    }
    return {"USB", Readiness::kReady, usb_text(device), ""};
  }
  return {"USB", Readiness::kAbsent, "no Touch on USB",
          "plug in its cable and its power; one on Ethernet or FireWire is seen by the library "
          "alone"};
}

std::vector<Sighting> TouchDriver::probe() {
  const Sighting usb = on_usb();
  const bool plugged = usb.readiness != Readiness::kAbsent;
  if (const auto api = load_hd(options_.library); !api) {
    const bool old = api.message().find(": has no ") != std::string::npos;
    return {usb, sighting_of(options_.library,
                             plugged || old ? Readiness::kUnfinished : Readiness::kAbsent,
                             api.message())};
  }
  const Sighting library = {options_.library, Readiness::kReady, "libHD is there", ""};
  if (plugged) return {usb, library};
  return {{"USB", Readiness::kReady, "no Touch on USB; libHD may have one on Ethernet or FireWire",
           "handrail devices test touch"},
          library};
}

StartedTest TouchDriver::start(const std::optional<TestWishes>& wishes) const {
  auto device = std::make_unique<TouchDevice>(options_);
  if (const Status opened = device->open(); !opened) return opened;
  return StartedTest(
      std::make_unique<TouchTrial>(std::move(device), wishes, touch_block(options_)));
}

StartedTest TouchDriver::test(const TestWishes& wishes) { return start(wishes); }

StartedTest TouchDriver::calibrate() { return start(std::nullopt); }

}  // namespace handrail
