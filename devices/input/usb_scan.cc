#include "devices/input/usb_scan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& path) {
  std::ifstream in(path);
  std::string out;
  std::getline(in, out);
  return out;
}

// Four hexadecimal digits, as the kernel writes them; 0: it is none.
std::uint16_t number_in(const fs::path& path) {
  const std::string text = first_line(path);
  std::uint16_t out = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out, 16);
  return error == std::errc() && end == text.data() + text.size() ? out : std::uint16_t{0};
}

}  // namespace

std::vector<UsbDevice> usb_devices(const std::string& folder) {
  std::vector<UsbDevice> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const UsbDevice device{number_in(entry.path() / "idVendor"),
                           number_in(entry.path() / "idProduct"),
                           shown(first_line(entry.path() / "product"))};
    if (device.vendor != 0) out.push_back(device);
  }
  // The kernel's order is not the same in every run.
  std::sort(out.begin(), out.end(), [](const UsbDevice& a, const UsbDevice& b) {
    return std::tie(a.vendor, a.product, a.name) < std::tie(b.vendor, b.product, b.name);
  });
  return out;
}

std::string usb_text(const UsbDevice& device) {
  std::array<char, 16> ids{};
  std::snprintf(ids.data(), ids.size(), "%04x:%04x", device.vendor, device.product);
  return std::string(ids.data()) + (device.name.empty() ? "" : " " + device.name);
}

}  // namespace handrail
