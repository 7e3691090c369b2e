#include "devices/melfa/r3_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "server/base/clock.h"

namespace handrail {
namespace {

constexpr Nanos kR3Connecting = kSecond;
constexpr Nanos kR3Answering = kSecond;
constexpr Nanos kR3Silence = 30 * kMillisecond;
constexpr Nanos kR3Glance = 50 * kMillisecond;  // between two looks whether somebody wants an end

constexpr char kReachNext[] =
    "robot { address command_port } in the slave's file; is the controller on, and its TCP server?";
constexpr char kWhoNext[] = "is that the controller's address and command_port?";
constexpr char kBrokenOff[] = "broken off";

Status connect_within(int fd, const sockaddr_in& to, const std::function<bool(short)>& wait) {
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return Status::ok();
  if (errno != EINPROGRESS) return Status::error(std::strerror(errno));
  if (!wait(POLLOUT)) return Status::error("no answer within 1 s");
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
  return error == 0 ? Status::ok() : Status::error(std::strerror(error));
}

}  // namespace

Result<std::unique_ptr<R3Socket>> R3Socket::connect(const std::string& address, std::uint16_t port,
                                                    Interrupted interrupted) {
  const std::string place = address + ":" + std::to_string(port);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) {
    return Status::error(place + ": '" + address + "', expected an IPv4 address; " + kReachNext);
  }
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return Status::error(place + ": " + std::strerror(errno));
  std::unique_ptr<R3Socket> out(new R3Socket(fd, place, std::move(interrupted)));
  const Nanos until = monotonic_now() + kR3Connecting;
  const Status connected =
      connect_within(fd, to, [&](short events) { return out->wait(events, until); });
  if (!connected) {
    if (out->interrupted()) return Status::error(place + ": " + kBrokenOff);
    return Status::error(place + ": cannot be reached: " + connected.message() + "; " + kReachNext);
  }
  return out;
}

R3Socket::~R3Socket() { ::close(fd_); }

bool R3Socket::interrupted() const { return interrupted_ && interrupted_(); }

// False: nothing came until then, or somebody wants an end.
bool R3Socket::wait(short events, Nanos until) const {
  for (;;) {
    const Nanos left = until - monotonic_now();
    if (left <= 0 || (!finishing_ && interrupted())) return false;
    pollfd waits{fd_, events, 0};
    const Nanos time = std::min(left, kR3Glance) + kMillisecond - 1;
    if (::poll(&waits, 1, static_cast<int>(time / kMillisecond)) > 0) return true;
  }
}

void R3Socket::pause(Nanos time) {
  const Nanos until = monotonic_now() + time;
  for (Nanos left = time; left > 0; left = until - monotonic_now()) {
    if (!finishing_ && interrupted()) return;
    ::poll(nullptr, 0, static_cast<int>(std::min(left, kR3Glance) / kMillisecond) + 1);
  }
}

// An answer that came too late is not the next one's.
void R3Socket::drop_waiting() const {
  std::array<char, kMostR3Answer> waiting{};
  for (int i = 0; i < 100 && ::recv(fd_, waiting.data(), waiting.size(), 0) > 0; ++i) {
  }
}

Status R3Socket::cannot(const std::string& cause, const std::string& next) const {
  if (!finishing_ && interrupted()) return Status::error(kBrokenOff);
  return Status::error(place_ + ": " + cause + "; " + next);
}

Result<R3Answer> R3Socket::ask(const std::string& order) {
  if (!finishing_ && interrupted()) return Status::error(kBrokenOff);
  drop_waiting();
  if (::send(fd_, order.data(), order.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(order.size())) {
    return cannot(std::string("cannot be told ") + order + ": " + std::strerror(errno), kReachNext);
  }
  R3Reader reader;
  const Nanos most = monotonic_now() + kR3Answering;
  for (Nanos until = most; wait(POLLIN, until);) {
    std::array<char, kMostR3Answer> piece{};
    const ssize_t n = ::recv(fd_, piece.data(), piece.size(), 0);
    if (n < 0 && errno == EAGAIN) continue;
    if (n <= 0) {
      if (!reader.text().empty()) break;
      return cannot("the connection was closed at " + order,
                    "another program may have the controller's only one: end that");
    }
    const auto said = reader.take({piece.data(), static_cast<std::size_t>(n)});
    if (said != R3Reader::Said::kMore) break;
    until = std::min(most, monotonic_now() + kR3Silence);
  }
  if (reader.text().empty()) return cannot("no answer to " + order + " within 1 s", kWhoNext);
  auto answer = parse_r3_answer(reader.text());
  if (!answer) return cannot("after " + order + " " + answer.message(), kWhoNext);
  return answer;
}

}  // namespace handrail
