// Datagrams within this computer: a sender, and a way between two programs that a test can look at
// and speak on.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "server/base/own_places.h"
#include "server/base/time.h"

namespace handrail {

inline sockaddr_in local_address(int port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = ::inet_addr(own_address().c_str());
  out.sin_port = htons(static_cast<std::uint16_t>(port));
  return out;
}

// From a port that nobody expects anything from.
class UdpSender {
 public:
  UdpSender() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~UdpSender() { ::close(fd_); }
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  void send(int port, std::span<const std::uint8_t> bytes) {
    const sockaddr_in to = local_address(port);
    (void)!::sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                    sizeof to);
  }

 private:
  int fd_;
};

// Between a client, who sends to port(), and a server at another port of this computer, who takes
// the relay for the client. Forwards in a thread of its own; the client is whoever sent last.
class UdpRelay {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Watch = std::function<void(bool to_server, std::span<const std::uint8_t> bytes)>;

  // `begin` is called once in the relay's thread, `watch` there before a datagram goes on.
  explicit UdpRelay(int server_port, Watch watch = {}, std::function<void()> begin = {})
      : watch_(std::move(watch)) {
    front_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    back_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const sockaddr_in any = local_address(0), server = local_address(server_port);
    socklen_t size = sizeof any;
    sockaddr_in own{};
    good_ = ::bind(front_, reinterpret_cast<const sockaddr*>(&any), size) == 0 &&
            ::getsockname(front_, reinterpret_cast<sockaddr*>(&own), &size) == 0 &&
            ::connect(back_, reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0;
    port_ = ntohs(own.sin_port);
    thread_ = std::thread([this, begin = std::move(begin)] {
      if (begin) begin();
      run();
    });
  }
  ~UdpRelay() {
    ends_ = true;
    thread_.join();
    ::close(front_);
    ::close(back_);
  }
  UdpRelay(const UdpRelay&) = delete;
  UdpRelay& operator=(const UdpRelay&) = delete;

  bool good() const { return good_; }
  int port() const { return port_; }
  // Where the client is; 0: it has not spoken yet.
  int client_port() const { return client_port_; }

  // As if the client, or the server, had sent it.
  void to_server(const Bytes& bytes) { (void)!::send(back_, bytes.data(), bytes.size(), 0); }
  void to_client(const Bytes& bytes) { send_front(bytes); }
  // The newest that passed, oldest first.
  std::vector<Bytes> seen(bool to_server) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto& from = seen_[to_server ? 1 : 0];
    return {from.begin(), from.end()};
  }

 private:
  static constexpr std::size_t kSeen = 200;  // datagrams kept each way
  static constexpr int kLook = 20;           // at the end of the relay [ms]

  void send_front(std::span<const std::uint8_t> bytes) {
    const sockaddr_in to = local_address(client_port_);
    (void)!::sendto(front_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                    sizeof to);
  }

  void run() {
    std::array<pollfd, 2> ends{pollfd{front_, POLLIN, 0}, pollfd{back_, POLLIN, 0}};
    while (!ends_) {
      if (::poll(ends.data(), ends.size(), kLook) <= 0) continue;
      for (const bool to_server : {true, false}) take(to_server);
    }
  }

  void take(bool to_server) {
    std::array<std::uint8_t, 2048> buffer;
    for (;;) {
      sockaddr_in from{};
      socklen_t size = sizeof from;
      const ssize_t n = ::recvfrom(to_server ? front_ : back_, buffer.data(), buffer.size(),
                                   MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
      if (n < 0) return;
      const std::span<const std::uint8_t> bytes(buffer.data(), static_cast<std::size_t>(n));
      if (watch_) watch_(to_server, bytes);
      if (to_server) {
        client_port_ = ntohs(from.sin_port);
        (void)!::send(back_, bytes.data(), bytes.size(), 0);
      } else if (client_port_ != 0) {
        send_front(bytes);
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      auto& seen = seen_[to_server ? 1 : 0];
      if (seen.size() == kSeen) seen.pop_front();
      seen.emplace_back(bytes.begin(), bytes.end());
    }
  }

  const Watch watch_;
  int front_ = -1, back_ = -1, port_ = 0;
  bool good_ = false;
  std::atomic<int> client_port_{0};
  mutable std::mutex mutex_;
  std::array<std::deque<Bytes>, 2> seen_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace handrail
