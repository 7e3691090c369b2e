// Which USB devices the kernel has found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace handrail {

// Where the kernel lists them (Linux, Documentation/ABI/stable/sysfs-bus-usb).
inline constexpr char kUsbFolder[] = "/sys/bus/usb/devices";

struct UsbDevice {
  std::uint16_t vendor = 0, product = 0;
  std::string name;  // as it calls itself; empty: it does not
};

// Those in `folder`; none where it cannot be read.
std::vector<UsbDevice> usb_devices(const std::string& folder);

// "046d:c626 SpaceNavigator".
std::string usb_text(const UsbDevice& device);

}  // namespace handrail
