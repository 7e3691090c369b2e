#include "devices/net_ft/net_ft_page_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "server/base/clock.h"

namespace handrail {
namespace {

// Some ten times what the page of a Net F/T has.
constexpr std::size_t kMostPage = 100'000;  // [bytes]

class TcpSocket {
 public:
  explicit TcpSocket(Nanos until)
      : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)), until_(until) {}
  ~TcpSocket() {
    if (fd_ >= 0) ::close(fd_);
  }
  TcpSocket(const TcpSocket&) = delete;
  TcpSocket& operator=(const TcpSocket&) = delete;

  // Each false: errno says why.
  bool connect(const sockaddr_in& to) {
    if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return true;
    if (errno != EINPROGRESS || !wait(POLLOUT)) return false;
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return false;
    errno = error;
    return error == 0;
  }
  bool send(const std::string& text) {
    const ssize_t n = ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
    return n == static_cast<ssize_t>(text.size());
  }
  // All until the other end closes.
  bool receive(std::string& out) {
    for (;;) {
      if (!wait(POLLIN)) return false;
      std::array<char, 4096> part{};
      const ssize_t n = ::recv(fd_, part.data(), part.size(), 0);
      if (n == 0) return true;
      if (n < 0) return false;
      out.append(part.data(), static_cast<std::size_t>(n));
      if (out.size() <= kMostPage) continue;
      errno = EMSGSIZE;
      return false;
    }
  }

 private:
  bool wait(short events) const {
    const Nanos left = until_ - monotonic_now();
    pollfd waits{fd_, events, 0};
    if (left > 0 && ::poll(&waits, 1, static_cast<int>(left / kMillisecond) + 1) == 1) return true;
    errno = ETIMEDOUT;
    return false;
  }

  int fd_;
  Nanos until_;
};

}  // namespace

Result<std::string> fetch_net_ft_page(const std::string& address, std::uint16_t port,
                                      Nanos patience) {
  const std::string place = "http://" + address + ":" + std::to_string(port) + "/netftapi2.xml";
  const auto cannot = [&place](const std::string& cause) {
    return Status::error(place + " cannot be read: " + cause);
  };
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) {
    return cannot("expected an IPv4 address");
  }
  TcpSocket socket(monotonic_now() + patience);
  std::string text;
  if (!socket.connect(to) ||
      !socket.send("GET /netftapi2.xml HTTP/1.0\r\nHost: " + address + "\r\n\r\n") ||
      !socket.receive(text)) {
    return cannot(std::strerror(errno));
  }
  const std::size_t body = text.find("\r\n\r\n");
  const std::string line = text.substr(0, text.find("\r\n"));
  if (body == std::string::npos || !line.starts_with("HTTP/1.") ||
      line.find(" 200") == std::string::npos) {
    return cannot("expected HTTP 200, got '" + line.substr(0, 40) + "'");
  }
  return text.substr(body + 4);
}

}  // namespace handrail
