// Preloaded into a program: a FIFO whose name ends in ".switch" answers as the kernel's input
// device of a foot switch does, with the one key KEY_B. Its events are what is written into the
// FIFO.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <string_view>

namespace {

using Control = int (*)(int, unsigned long, ...);

bool is_switch(int fd) {
  struct stat found {};
  if (::fstat(fd, &found) != 0 || !S_ISFIFO(found.st_mode)) return false;
  std::array<char, 64> link{};
  std::array<char, PATH_MAX> path{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", fd);
  const ssize_t n = ::readlink(link.data(), path.data(), path.size());
  return n > 0 && std::string_view(path.data(), static_cast<std::size_t>(n)).ends_with(".switch");
}

int answer(unsigned long request, void* argument) {
  const auto number = _IOC_NR(request);
  if (request == EVIOCGRAB) return 0;
  if (_IOC_DIR(request) != _IOC_READ) return -1;
  std::memset(argument, 0, _IOC_SIZE(request));
  if (number == _IOC_NR(EVIOCGNAME(0))) {
    std::strncpy(static_cast<char*>(argument), "made-up foot switch", _IOC_SIZE(request) - 1);
  }
  if (number == _IOC_NR(EVIOCGBIT(EV_KEY, 0))) {
    constexpr int kBits = sizeof(unsigned long) * CHAR_BIT;
    static_cast<unsigned long*>(argument)[KEY_B / kBits] |= 1ul << KEY_B % kBits;
  }
  return 0;
}

}  // namespace

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* const argument = va_arg(more, void*);
  va_end(more);
  if (_IOC_TYPE(request) == 'E' && is_switch(fd)) return answer(request, argument);
  static const auto kernel = reinterpret_cast<Control>(::dlsym(RTLD_NEXT, "ioctl"));
  return kernel(fd, request, argument);
}
