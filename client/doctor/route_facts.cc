#include <ifaddrs.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <utility>

#include "client/doctor/gather.h"

namespace handrail {
namespace {

struct Socket {
  explicit Socket(int family) : fd(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (fd >= 0) ::close(fd);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  const int fd;
};

// "192.0.2.7:47002", "[2001:db8::7]:47002": what stands for the host, and for the port.
std::pair<std::string, std::string> apart(const std::string& place) {
  const std::size_t colon = place.rfind(':');
  if (colon == std::string::npos) return {place, ""};
  std::string host = place.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return {host, place.substr(colon + 1)};
}

bool same_address(const sockaddr* a, const sockaddr_storage& b) {
  if (a == nullptr || a->sa_family != b.ss_family) return false;
  if (a->sa_family == AF_INET) {
    const auto& x = *reinterpret_cast<const sockaddr_in*>(a);
    const auto& y = reinterpret_cast<const sockaddr_in&>(b);
    return x.sin_addr.s_addr == y.sin_addr.s_addr;
  }
  if (a->sa_family != AF_INET6) return false;
  const auto& x = *reinterpret_cast<const sockaddr_in6*>(a);
  const auto& y = reinterpret_cast<const sockaddr_in6&>(b);
  return std::memcmp(&x.sin6_addr, &y.sin6_addr, sizeof x.sin6_addr) == 0;
}

std::string interface_of(const sockaddr_storage& own) {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return {};
  std::string out;
  for (const ifaddrs* one = all; one != nullptr && out.empty(); one = one->ifa_next) {
    if (same_address(one->ifa_addr, own)) out = one->ifa_name;
  }
  ::freeifaddrs(all);
  return out;
}

Tunnel tunnel_of(const std::string& interface) {
  std::ifstream events("/sys/class/net/" + interface + "/uevent");
  for (std::string line; std::getline(events, line);) {
    if (line == "DEVTYPE=wireguard") return Tunnel::kWireGuard;
  }
  // One that a program makes, not the kernel, has only its name.
  if (interface.starts_with("wg")) return Tunnel::kWireGuard;
  return interface.starts_with("tailscale") ? Tunnel::kTailscale : Tunnel::kNone;
}

}  // namespace

RouteFacts route_facts(const std::string& to) {
  RouteFacts out;
  out.to = to;
  const auto [host, port] = apart(to);
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0) {
    out.problem = ::gai_strerror(error);
    return out;
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> address(found, &::freeaddrinfo);
  const Socket socket(address->ai_family);
  out.v6 = address->ai_family == AF_INET6;
  // Sends nothing: the kernel looks the way up.
  if (socket.fd < 0 || ::connect(socket.fd, address->ai_addr, address->ai_addrlen) != 0) {
    out.problem = std::strerror(errno);
    return out;
  }
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  if (::getsockname(socket.fd, reinterpret_cast<sockaddr*>(&own), &size) == 0) {
    out.interface = interface_of(own);
  }
  socklen_t length = sizeof out.mtu;
  const int got = out.v6 ? ::getsockopt(socket.fd, IPPROTO_IPV6, IPV6_MTU, &out.mtu, &length)
                         : ::getsockopt(socket.fd, IPPROTO_IP, IP_MTU, &out.mtu, &length);
  if (got != 0) out.mtu = 0;
  out.tunnel = tunnel_of(out.interface);
  return out;
}

}  // namespace handrail
