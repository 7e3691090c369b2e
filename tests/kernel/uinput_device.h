// An input device that this program makes for the kernel.
#pragma once

#include <dirent.h>
#include <fcntl.h>
#include <linux/uinput.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

namespace handrail::kernel {

// Plugged in from its constructor to its destructor. `link` leads to its device, as udev's links
// do, and to nothing while it is unplugged. One with `effects` has motors for so many constant
// forces, for which somebody has to answer (uinput_motors.h).
class UinputDevice {
 public:
  UinputDevice(const char* name, const std::vector<int>& keys, const std::vector<int>& axes,
               std::string link, int effects = 0)
      : link_(std::move(link)), fd_(::open("/dev/uinput", O_RDWR | O_NONBLOCK)) {
    if (fd_ < 0) return;
    if (effects > 0) ::ioctl(fd_, UI_SET_EVBIT, EV_FF);
    for (const int bit : {FF_CONSTANT, FF_GAIN, FF_AUTOCENTER}) {
      if (effects > 0) ::ioctl(fd_, UI_SET_FFBIT, bit);
    }
    ::ioctl(fd_, UI_SET_EVBIT, EV_KEY);
    for (const int key : keys) ::ioctl(fd_, UI_SET_KEYBIT, key);
    if (!axes.empty()) ::ioctl(fd_, UI_SET_EVBIT, EV_ABS);
    for (const int axis : axes) {
      uinput_abs_setup abs{};
      abs.code = static_cast<__u16>(axis);
      abs.absinfo.minimum = -32768;
      abs.absinfo.maximum = 32767;
      ::ioctl(fd_, UI_ABS_SETUP, &abs);
    }
    uinput_setup setup{};
    setup.id.bustype = BUS_USB;
    setup.ff_effects_max = static_cast<__u32>(effects);
    std::strncpy(setup.name, name, sizeof setup.name - 1);
    ::ioctl(fd_, UI_DEV_SETUP, &setup);
    if (::ioctl(fd_, UI_DEV_CREATE) == 0) find_event();
  }
  ~UinputDevice() {
    ::unlink(link_.c_str());
    if (fd_ < 0) return;
    ::ioctl(fd_, UI_DEV_DESTROY);
    ::close(fd_);
  }
  UinputDevice(const UinputDevice&) = delete;
  UinputDevice& operator=(const UinputDevice&) = delete;

  bool there() const { return !event_.empty(); }
  int fd() const { return fd_; }
  void send(int type, int code, int value) {
    for (const auto& [t, c, v] :
         {std::array{type, code, value}, std::array{EV_SYN, SYN_REPORT, 0}}) {
      input_event event{};
      event.type = static_cast<__u16>(t);
      event.code = static_cast<__u16>(c);
      event.value = v;
      [[maybe_unused]] const ssize_t n = ::write(fd_, &event, sizeof event);
    }
  }

 private:
  void find_event() {
    char system_name[64] = "";
    ::ioctl(fd_, UI_GET_SYSNAME(sizeof system_name), system_name);
    const std::string folder = std::string("/sys/devices/virtual/input/") + system_name;
    DIR* const open = ::opendir(folder.c_str());
    if (open == nullptr) return;
    while (const dirent* const entry = ::readdir(open)) {
      const std::string one = entry->d_name;
      if (one.starts_with("event")) event_ = "/dev/input/" + one;
    }
    ::closedir(open);
    ::unlink(link_.c_str());
    if (::symlink(event_.c_str(), link_.c_str()) != 0) event_.clear();
  }

  std::string link_, event_;
  int fd_;
};

}  // namespace handrail::kernel
