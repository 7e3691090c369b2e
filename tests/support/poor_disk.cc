// Preloaded into a program: a disk that is as the file $POOR_DISK says. "full" and "broken":
// nothing can be written, "slow": each write takes a second, "dead": none ends; anything else: as
// it is. For those who write at a place in a file, as the recorder does.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <string_view>

namespace {

std::string_view mode(std::array<char, 16>& text) {
  const char* path = std::getenv("POOR_DISK");
  const int fd = path != nullptr ? ::open(path, O_RDONLY | O_CLOEXEC) : -1;
  if (fd < 0) return {};
  const ssize_t size = ::read(fd, text.data(), text.size());
  ::close(fd);
  return {text.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
}

using Write = ssize_t (*)(int, const void*, size_t, off_t);

ssize_t write_poorly(int fd, const void* bytes, size_t size, off_t at) {
  static const auto real = reinterpret_cast<Write>(::dlsym(RTLD_NEXT, "pwrite"));
  std::array<char, 16> text{};
  const std::string_view now = mode(text);
  if (now == "full" || now == "broken") {
    errno = now == "full" ? ENOSPC : EIO;
    return -1;
  }
  const timespec second{1, 0};
  if (now == "slow") ::nanosleep(&second, nullptr);
  while (mode(text) == "dead") ::nanosleep(&second, nullptr);
  return real(fd, bytes, size, at);
}

}  // namespace

extern "C" ssize_t pwrite(int fd, const void* bytes, size_t size, off_t at) {
  return write_poorly(fd, bytes, size, at);
}

extern "C" ssize_t pwrite64(int fd, const void* bytes, size_t size, off_t at) {
  return write_poorly(fd, bytes, size, at);
}
