#include "devices/evdev/evdev_file.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <vector>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

// The kernel's bit fields are arrays of unsigned long.
constexpr std::size_t kWordBits = sizeof(unsigned long) * CHAR_BIT;
template <std::size_t kCount>
using Words = std::array<unsigned long, (kCount + kWordBits - 1) / kWordBits>;

template <std::size_t kCount>
std::bitset<kCount> bits_of(const Words<kCount>& words) {
  std::bitset<kCount> out;
  for (std::size_t i = 0; i < kCount; ++i)
    out[i] = (words[i / kWordBits] >> i % kWordBits & 1) != 0;
  return out;
}

std::string next_step_at(int error) {
  switch (error) {
    case ENOENT: return "is it plugged in? `ls /dev/input/by-id` shows what is";
    case EACCES:
      return "this user must be in the group input: sudo usermod -aG input $USER, then log in anew";
    case ENOTTY:
    case EINVAL: return "expected an input device such as /dev/input/event5";
    case EBUSY: return "another program has grabbed it: end that program";
    default: return "is it plugged in?";
  }
}

Status cannot_open(const std::string& path, const char* what, int error) {
  return Status::error("input device " + shown(path, 200) + ": " + what + ": " +
                       std::strerror(error) + "; " + next_step_at(error));
}

// Asks it all; false: errno says why.
bool ask(EvdevKernel& kernel, EvdevUse use, EvdevOpened& out) {
  Words<KEY_CNT> keys{}, down{};
  Words<ABS_CNT> axes{};
  if (kernel.control(out.fd, EVIOCGBIT(EV_KEY, sizeof keys), keys.data()) < 0) return false;
  if (kernel.control(out.fd, EVIOCGBIT(EV_ABS, sizeof axes), axes.data()) < 0) return false;
  // Before it is asked what is down: what is pressed later is an event of ours then.
  if (use == EvdevUse::kGrab && kernel.control(out.fd, EVIOCGRAB, reinterpret_cast<void*>(1)) < 0) {
    return false;
  }
  if (kernel.control(out.fd, EVIOCGKEY(sizeof down), down.data()) < 0) return false;
  // One without any says so, or that it does not know the question.
  Words<FF_CNT> effects{};
  if (kernel.control(out.fd, EVIOCGBIT(EV_FF, sizeof effects), effects.data()) < 0) effects = {};
  out.has_effect = bits_of<FF_CNT>(effects);
  out.has_key = bits_of<KEY_CNT>(keys);
  out.state.keys = bits_of<KEY_CNT>(down);
  const std::bitset<ABS_CNT> has = bits_of<ABS_CNT>(axes);
  for (unsigned int i = 0; i < ABS_CNT; ++i) {
    if (!has[i]) continue;
    input_absinfo axis{};
    if (kernel.control(out.fd, EVIOCGABS(i), &axis) < 0) return false;
    // One without a range says nothing.
    if (axis.minimum >= axis.maximum) continue;
    out.has_axis[i] = true;
    out.ranges[i] = {axis.minimum, axis.maximum, axis.flat};
    out.state.axes[i] = axis.value;
  }
  return true;
}

}  // namespace

int EvdevKernel::open(const char* path) noexcept {
  return ::open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

int EvdevKernel::control(int fd, unsigned long request, void* argument) noexcept {
  return ::ioctl(fd, request, argument);
}

int EvdevKernel::open_to_write(const char* path) noexcept {
  return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

bool EvdevKernel::write(int fd, const input_event& event) noexcept {
  return ::write(fd, &event, sizeof event) == static_cast<ssize_t>(sizeof event);
}

EvdevKernel& evdev_kernel() noexcept {
  static EvdevKernel kernel;
  return kernel;
}

Result<EvdevOpened> open_evdev(EvdevKernel& kernel, const std::string& path, EvdevUse use) {
  EvdevOpened out;
  out.fd = kernel.open(path.c_str());
  if (out.fd < 0) return cannot_open(path, "cannot be opened", errno);
  if (!ask(kernel, use, out)) {
    const int error = errno;
    ::close(out.fd);
    return cannot_open(path, "cannot be used", error);
  }
  std::array<char, 80> name{};
  // Some have none.
  (void)kernel.control(out.fd, EVIOCGNAME(name.size() - 1), name.data());
  out.name = fixed_text<decltype(out.name)>(shown(name.data()));
  out.path = fixed_text<decltype(out.path)>(path);
  return out;
}

}  // namespace handrail
