#include "devices/spacemouse/spacemouse_driver.h"

#include <unistd.h>

#include <utility>

#include "devices/self_test/hand_test.h"
#include "devices/spacemouse/spacemouse_calibration.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

// 3Dconnexion's own number, and those that its devices had at Logitech (spacenavd, src/dev.c).
constexpr std::uint16_t kThreeDConnexion = 0x256f, kLogitech = 0x046d;
constexpr std::uint16_t kFirstAtLogitech = 0xc603, kLastAtLogitech = 0xc640;

bool is_space_mouse(const UsbDevice& d) {
  if (d.vendor == kThreeDConnexion) return true;
  return d.vendor == kLogitech && d.product >= kFirstAtLogitech && d.product <= kLastAtLogitech &&
         d.name.find("Space") != std::string::npos;
}

Sighting cap_on_usb(const std::string& folder) {
  for (const UsbDevice& device : usb_devices(folder)) {
    if (!is_space_mouse(device)) continue;
    return {"USB", Readiness::kReady, usb_text(device), ""};
  }
  return {"USB", Readiness::kAbsent, "no SpaceMouse on USB",
          "plug it in; only spacenavd sees one on a serial port or by Bluetooth"};
}

}  // namespace

std::string spacemouse_block(const SpaceMouseOptions& o) {
  return "device { kind: SPACEMOUSE spacemouse { " +
         (o.socket.empty() ? "" : "socket: \"" + o.socket + "\" ") +
         "full_counts: " + number_text(o.full_counts) + " } }";
}

std::vector<Sighting> SpaceMouseDriver::probe() {
  const std::string path = spnav_socket_path(options_.socket);
  Sighting cap = cap_on_usb(usb_folder_);
  const bool plugged = cap.readiness == Readiness::kReady;
  Sighting daemon{path, Readiness::kReady, "spacenavd answers", ""};
  if (const auto opened = connect_spnav(path)) {
    ::close(opened->fd);
  } else {
    daemon =
        sighting_of(path, plugged ? Readiness::kUnfinished : Readiness::kAbsent, opened.message());
    daemon.fact = "spacenavd cannot be reached: " + daemon.fact;
  }
  if (!plugged && daemon.readiness == Readiness::kReady) {
    cap = {"USB", Readiness::kReady,
           "no SpaceMouse on USB; spacenavd may have one on a serial port or by Bluetooth",
           "handrail devices test spacemouse"};
  }
  return {cap, daemon};
}

StartedTest SpaceMouseDriver::test(const TestWishes& wishes) {
  auto device = std::make_unique<SpaceMouseDevice>(options_);
  if (const Status opened = device->open(); !opened) return opened;
  return StartedTest(
      std::make_unique<HandTest>(std::move(device), wishes, spacemouse_block(options_)));
}

StartedTest SpaceMouseDriver::calibrate() {
  const auto connection = connect_spnav(spnav_socket_path(options_.socket));
  if (!connection) return connection.status();
  return StartedTest(std::make_unique<SpaceMouseCalibration>(connection->fd, options_));
}

}  // namespace handrail
