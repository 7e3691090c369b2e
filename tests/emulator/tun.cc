#include "tests/emulator/tun.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <linux/ipv6.h>
#include <net/if.h>
#include <net/route.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "tests/emulator/addresses.h"

namespace handrail::emulator {
namespace {

// Packets that wait for the emulator: a tenth of a second of the fastest flood it is made for.
constexpr int kQueue = 10'000;

class Socket {
 public:
  explicit Socket(int family) : fd_(::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

Status refused(const std::string& what) {
  return Status::error(what + ": " + std::generic_category().message(errno));
}

ifreq request(const char* device) {
  ifreq out{};
  std::strncpy(out.ifr_name, device, IFNAMSIZ - 1);
  return out;
}

Status bring_up(const Socket& socket, const char* device) {
  ifreq asked = request(device);
  asked.ifr_flags = IFF_UP | IFF_RUNNING;
  if (::ioctl(socket.fd(), SIOCSIFFLAGS, &asked) != 0) return refused(device);
  return Status::ok();
}

sockaddr ip_4(const char* text) {
  sockaddr_in made{};
  made.sin_family = AF_INET;
  ::inet_pton(AF_INET, text, &made.sin_addr);
  sockaddr out{};
  std::memcpy(&out, &made, sizeof made);
  return out;
}

Status give_4(const Socket& socket, const char* address) {
  ifreq asked = request(kTunName);
  asked.ifr_addr = ip_4(address);
  if (::ioctl(socket.fd(), SIOCSIFADDR, &asked) != 0) return refused("its IPv4 address");
  asked = request(kTunName);
  asked.ifr_netmask = ip_4("255.255.255.255");
  if (::ioctl(socket.fd(), SIOCSIFNETMASK, &asked) != 0) return refused("its IPv4 mask");
  return Status::ok();
}

Status route_4(const Socket& socket) {
  rtentry route{};
  route.rt_dst = route.rt_genmask = route.rt_gateway = ip_4("0.0.0.0");
  route.rt_flags = RTF_UP;
  std::string device = kTunName;
  route.rt_dev = device.data();
  if (::ioctl(socket.fd(), SIOCADDRT, &route) != 0) return refused("its IPv4 route");
  return Status::ok();
}

Status give_6(const char* address) {
  const Socket socket(AF_INET6);
  if (socket.fd() < 0 && errno == EAFNOSUPPORT) return Status::ok();
  const int index = static_cast<int>(::if_nametoindex(kTunName));
  in6_ifreq asked{};
  ::inet_pton(AF_INET6, address, &asked.ifr6_addr);
  asked.ifr6_prefixlen = 128;
  asked.ifr6_ifindex = index;
  if (::ioctl(socket.fd(), SIOCSIFADDR, &asked) != 0) return refused("its IPv6 address");
  in6_rtmsg route{};
  route.rtmsg_flags = RTF_UP;
  route.rtmsg_metric = 1;
  route.rtmsg_ifindex = index;
  if (::ioctl(socket.fd(), SIOCADDRT, &route) != 0) return refused("its IPv6 route");
  return Status::ok();
}

Status set_up(Side side, int mtu) {
  const Socket socket(AF_INET);
  if (socket.fd() < 0) return refused("a socket");
  if (Status up = bring_up(socket, "lo"); !up) return up;
  ifreq asked = request(kTunName);
  asked.ifr_mtu = mtu;
  if (::ioctl(socket.fd(), SIOCSIFMTU, &asked) != 0) return refused("an MTU");
  asked = request(kTunName);
  asked.ifr_qlen = kQueue;
  (void)::ioctl(socket.fd(), SIOCSIFTXQLEN, &asked);  // root's alone; else 500 packets wait
  if (Status s = give_4(socket, side == Side::kNear ? kNear4 : kFar4); !s) return s;
  if (Status s = bring_up(socket, kTunName); !s) return s;
  if (Status s = route_4(socket); !s) return s;
  return give_6(side == Side::kNear ? kNear6 : kFar6);
}

}  // namespace

Result<int> open_wire(Side side, int mtu) {
  const int fd = ::open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return refused("/dev/net/tun");
  ifreq asked = request(kTunName);
  asked.ifr_flags = IFF_TUN | IFF_NO_PI;
  Status made = ::ioctl(fd, TUNSETIFF, &asked) == 0 ? Status::ok() : refused("a TUN device");
  if (made) {
    made = set_up(side, mtu);
    if (!made) made = Status::error("a TUN device: " + made.message());
  }
  if (made) return fd;
  ::close(fd);
  return made;
}

}  // namespace handrail::emulator
