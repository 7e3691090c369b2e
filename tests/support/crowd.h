// Clients of a master's operator socket that keep it busy: idle, asking, half a frame, garbage,
// orders that are refused, and connections that come and go.
#pragma once

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "proto/operator.pb.h"
#include "server/base/clock.h"
#include "server/base/length_prefix.h"
#include "server/base/pacer.h"
#include "server/base/random.h"

namespace handrail {

// One thread serves them all, and each acts once in every `period`. While it lives.
class Crowd {
 public:
  enum class Kind { kIdle, kAsks, kHalfAFrame, kGarbage, kRefusedOrders, kComesAndGoes };
  static constexpr int kKinds = 6;

  struct Counts {
    std::uint64_t acts = 0, connects = 0, answers = 0;
  };

  // `size` clients, of all kinds in turn, at the socket at `path`.
  Crowd(const std::string& path, int size, Nanos period, std::uint64_t seed = 1)
      : period_(period), random_(seed) {
    allow_descriptors(static_cast<rlim_t>(size) + 256);
    address_.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), address_.sun_path);
    pb::Request status;
    status.set_status(true);
    status_ = framed(status.SerializeAsString());
    for (int i = 0; i < size; ++i) {
      clients_.push_back({static_cast<Kind>(i % kKinds), -1, share(period), refused_order(i)});
    }
    thread_ = std::thread([this] { run(); });
  }
  ~Crowd() {
    ends_ = true;
    thread_.join();
    for (Member& client : clients_) leave(client);
  }
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  Counts counts() const { return {acts_, connects_, answers_}; }

 private:
  struct Member {
    Kind kind;
    int fd;
    Nanos due;  // from the start on
    std::string order;
    bool waits = false;  // for an answer
    bool said = false;   // on this connection
  };

  static void allow_descriptors(rlim_t wanted) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = std::max(limit.rlim_cur, std::min(limit.rlim_max, wanted));
    ::setrlimit(RLIMIT_NOFILE, &limit);
  }

  Nanos share(Nanos time) {
    return static_cast<Nanos>(random_.uniform() * static_cast<double>(time));
  }

  // Of somebody who does not hold the lease.
  static std::string refused_order(int number) {
    pb::Request request;
    request.set_as("crowd-" + std::to_string(number));
    if (number / kKinds % 2 == 0) {
      request.set_disengage(true);
    } else {
      request.mutable_lease()->set_act(pb::LeaseOrder::SHOW);
    }
    return framed(request.SerializeAsString());
  }

  void run() {
    const Nanos start = monotonic_now();
    while (!ends_) {
      const Nanos now = monotonic_now() - start;
      for (Member& client : clients_) {
        if (now < client.due) continue;
        client.due = now + period_ / 2 + share(period_);
        act(client);
        ++acts_;
      }
      sleep_until(monotonic_now() + kMillisecond);
    }
  }

  void act(Member& client) {
    if (client.kind == Kind::kComesAndGoes) leave(client);
    read(client);
    if (client.fd < 0 && !enter(client)) return;
    switch (client.kind) {
      case Kind::kIdle:
      case Kind::kComesAndGoes: return;
      case Kind::kAsks: return ask(client, status_);
      case Kind::kRefusedOrders: return ask(client, client.order);
      case Kind::kHalfAFrame:
        if (!std::exchange(client.said, true)) say(client, status_.substr(0, 5));
        return;
      case Kind::kGarbage:
        if (!std::exchange(client.said, true)) say(client, framed("\xff\xff\xff\xff"));
        return;
    }
  }

  void ask(Member& client, const std::string& frame) {
    if (!std::exchange(client.waits, true)) say(client, frame);
  }

  bool enter(Member& client) {
    client.fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (client.fd < 0) return false;
    if (::connect(client.fd, reinterpret_cast<const sockaddr*>(&address_), sizeof address_) != 0) {
      leave(client);
      return false;
    }
    ++connects_;
    client.waits = client.said = false;
    return true;
  }
  void leave(Member& client) {
    if (client.fd >= 0) ::close(std::exchange(client.fd, -1));
  }
  void say(Member& client, const std::string& bytes) {
    if (::send(client.fd, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
      leave(client);
    }
  }
  // What has come; who was cut off comes again.
  void read(Member& client) {
    std::array<char, 4096> bytes;
    while (client.fd >= 0) {
      const ssize_t n = ::recv(client.fd, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (n < 0 && errno == EAGAIN) return;
      if (n <= 0) return leave(client);
      if (std::exchange(client.waits, false)) ++answers_;
    }
  }

  const Nanos period_;
  Random random_;
  sockaddr_un address_{};
  std::string status_;
  std::vector<Member> clients_;
  std::atomic<std::uint64_t> acts_{0}, connects_{0}, answers_{0};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace handrail
