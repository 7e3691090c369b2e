#include "devices/spacemouse/spnav_socket.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "devices/spacemouse/spnav_stream.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr char kUsualSocket[] = "/var/run/spnav.sock";
constexpr std::uint32_t kWantedProtocol = 1;

std::string next_step(int error) {
  switch (error) {
    case ENOENT: return "is spacenavd installed and started? (Debian: apt-get install spacenavd)";
    case ECONNREFUSED: return "nobody listens there any more: start spacenavd anew";
    case EACCES: return "this user may not use it: see its mode and its folder's";
    case EAGAIN: return "spacenavd does not answer: start it anew";
    default: return "expected spacenavd's socket";
  }
}

Status cannot(const std::string& path, int error) {
  return Status::error("SpaceMouse: cannot reach spacenavd at " + shown(path, 200) + ": " +
                       std::strerror(error) + "; " + next_step(error));
}

}  // namespace

std::string spnav_socket_path(const std::string& configured) {
  if (!configured.empty()) return configured;
  const char* said = std::getenv("SPNAV_SOCKET");
  return said != nullptr && *said != '\0' ? said : kUsualSocket;
}

Result<SpnavConnection> connect_spnav(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    return Status::error("SpaceMouse: '" + shown(path, 200) + "' has " +
                         std::to_string(path.size()) +
                         " bytes, expected the path of a Unix socket, 1 to " +
                         std::to_string(sizeof address.sun_path - 1));
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return cannot(path, errno);
  const std::uint32_t word = kSpnavProtocol | kWantedProtocol;
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::send(fd, &word, sizeof word, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof word)) {
    const int error = errno;
    ::close(fd);
    return cannot(path, error);
  }
  return SpnavConnection{fd};
}

}  // namespace handrail
