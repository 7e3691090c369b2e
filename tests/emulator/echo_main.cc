// handrail-netfault-echo: what the emulator's tests run on its sides. Datagrams are sent back, or
// sent and waited for; what comes back is counted by the number it carries.
#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "server/base/clock.h"
#include "server/base/fnv.h"
#include "server/base/time.h"
#include "server/base/version.h"

namespace {

using namespace handrail;

const char kUsage[] =
    "usage: handrail-netfault-echo serve PORT\n"
    "       handrail-netfault-echo ping ADDRESS PORT COUNT EVERY_US WAIT_MS\n";

constexpr std::size_t kBytes = 200;  // about a datagram of the link's

struct Datagram {
  std::uint64_t number = 0;
  Nanos sent = 0;
  std::array<std::uint8_t, kBytes> rest{};
  std::uint64_t sum = 0;  // of all before
};

std::uint64_t sum_of(const Datagram& datagram) {
  Fnv fnv;
  fnv.u64(datagram.number).u64(static_cast<std::uint64_t>(datagram.sent));
  for (const std::uint8_t byte : datagram.rest) fnv.u64(byte);
  return fnv.value();
}

// Whether this is what ping sends, as it sent it.
bool is_whole(const Datagram& datagram, ssize_t size) {
  return size == sizeof datagram && datagram.sum == sum_of(datagram);
}

int open_socket(int family) { return ::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0); }

// Sends everything back to where it is from, and names everybody once.
int serve(int port) {
  const int socket = open_socket(AF_INET6);
  const int off = 0;
  ::setsockopt(socket, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  sockaddr_in6 own{};
  own.sin6_family = AF_INET6;
  own.sin6_port = htons(static_cast<std::uint16_t>(port));
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
    std::perror("bind");
    return 1;
  }
  std::printf("SERVES\n");
  std::set<std::string> known;
  for (std::array<char, 2048> bytes{};;) {
    sockaddr_in6 from{};
    socklen_t length = sizeof from;
    const ssize_t size = ::recvfrom(socket, bytes.data(), bytes.size(), 0,
                                    reinterpret_cast<sockaddr*>(&from), &length);
    if (size < 0) continue;
    (void)!::sendto(socket, bytes.data(), static_cast<std::size_t>(size), 0,
                    reinterpret_cast<const sockaddr*>(&from), length);
    std::array<char, INET6_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET6, &from.sin6_addr, text.data(), text.size());
    const std::string who = std::string(text.data()) + " " + std::to_string(ntohs(from.sin6_port));
    if (known.insert(who).second) std::printf("FROM %s\n", who.c_str());
  }
}

struct Pings {
  std::vector<Nanos> trips;        // round trips of first answers
  std::vector<std::uint8_t> seen;  // answers by number
  std::uint64_t again = 0, broken = 0;
};

void take_answers(int socket, Pings& pings) {
  Datagram got;
  for (ssize_t size; (size = ::recv(socket, &got, sizeof got, MSG_DONTWAIT)) >= 0;) {
    if (!is_whole(got, size) || got.number >= pings.seen.size()) {
      ++pings.broken;
    } else if (pings.seen[got.number]++ != 0) {
      ++pings.again;
    } else {
      pings.trips.push_back(monotonic_now() - got.sent);
    }
  }
}

void wait_until(int socket, Nanos until, Pings& pings) {
  for (Nanos left; (left = until - monotonic_now()) > 0;) {
    const timespec time{left / kSecond, left % kSecond};
    pollfd wait{socket, POLLIN, 0};
    if (::ppoll(&wait, 1, &time, nullptr) > 0) take_answers(socket, pings);
  }
}

int ping(const char* address, const char* port, std::size_t count, Nanos every, Nanos wait) {
  addrinfo hints{}, *to = nullptr;
  hints.ai_flags = AI_NUMERICHOST;
  hints.ai_socktype = SOCK_DGRAM;
  if (::getaddrinfo(address, port, &hints, &to) != 0) return 2;
  const int socket = open_socket(to->ai_family);
  ::prctl(PR_SET_TIMERSLACK, 1UL);
  Pings pings;
  pings.seen.resize(count);
  const Nanos start = monotonic_now();
  for (std::size_t i = 0; i < count; ++i) {
    Datagram datagram;
    datagram.number = i;
    datagram.rest.fill(0x5a);
    datagram.sent = monotonic_now();
    datagram.sum = sum_of(datagram);
    (void)!::sendto(socket, &datagram, sizeof datagram, 0, to->ai_addr, to->ai_addrlen);
    wait_until(socket, start + static_cast<Nanos>(i + 1) * every, pings);
  }
  wait_until(socket, monotonic_now() + wait, pings);
  ::freeaddrinfo(to);
  std::sort(pings.trips.begin(), pings.trips.end());
  const auto at = [&](double share) {
    if (pings.trips.empty()) return 0.0;
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(pings.trips.size() - 1));
    return to_seconds(pings.trips[rank]) * 1e6;
  };
  std::printf("PINGS sent=%zu answered=%zu again=%llu broken=%llu\n", count, pings.trips.size(),
              static_cast<unsigned long long>(pings.again),
              static_cast<unsigned long long>(pings.broken));
  std::printf("TRIPS us least=%.1f p50=%.1f p99=%.1f worst=%.1f\n", at(0), at(0.5), at(0.99),
              at(1));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-netfault-echo", argc, argv)) return 0;
  ::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::string verb = argc > 1 ? argv[1] : "";
  if (verb == "serve" && argc == 3) return serve(std::atoi(argv[2]));
  if (verb == "ping" && argc == 7) {
    return ping(argv[2], argv[3], static_cast<std::size_t>(std::atoi(argv[4])),
                std::atoi(argv[5]) * handrail::kMicrosecond,
                std::atoi(argv[6]) * handrail::kMillisecond);
  }
  std::fputs(kUsage, stderr);
  return 2;
}
