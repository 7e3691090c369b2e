// Datagrams within this computer, over UDP or Unix sockets: a sender, and a way between two
// programs that a test can look at and speak on.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/base/own_places.h"
#include "server/base/time.h"

namespace handrail {

// Where datagrams go.
struct DatagramPlace {
  sockaddr_storage at{};
  socklen_t size = 0;  // 0: nowhere

  DatagramPlace() = default;
  // A port of this user's own address; 0: any free one.
  explicit DatagramPlace(int port) : size(sizeof(sockaddr_in)) {
    auto& in = reinterpret_cast<sockaddr_in&>(at);
    in.sin_family = AF_INET;
    in.sin_addr.s_addr = ::inet_addr(own_address().c_str());
    in.sin_port = htons(static_cast<std::uint16_t>(port));
  }
  // The path of a Unix socket.
  explicit DatagramPlace(const std::string& path) : size(sizeof(sockaddr_un)) {
    auto& un = reinterpret_cast<sockaddr_un&>(at);
    un.sun_family = AF_UNIX;
    path.copy(un.sun_path, sizeof un.sun_path - 1);
  }
  int port() const {
    return size == 0 ? 0 : ntohs(reinterpret_cast<const sockaddr_in&>(at).sin_port);
  }
  const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&at); }
};

// A socket of its own at `own`, whose file it removes at the end. Never waits.
class PlacedSocket {
 public:
  explicit PlacedSocket(const DatagramPlace& own) : place_(own) {
    fd_ = ::socket(own.at.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    good_ = ::bind(fd_, own.address(), own.size) == 0;
    socklen_t size = sizeof place_.at;
    good_ = good_ && ::getsockname(fd_, reinterpret_cast<sockaddr*>(&place_.at), &size) == 0;
  }
  ~PlacedSocket() {
    ::close(fd_);
    const auto& un = reinterpret_cast<const sockaddr_un&>(place_.at);
    if (good_ && un.sun_family == AF_UNIX) ::unlink(un.sun_path);
  }
  PlacedSocket(const PlacedSocket&) = delete;
  PlacedSocket& operator=(const PlacedSocket&) = delete;

  bool good() const { return good_; }
  int fd() const { return fd_; }
  const DatagramPlace& place() const { return place_; }
  // False: it was not taken, as of a Unix socket whose queue is full.
  bool send(const DatagramPlace& to, std::span<const std::uint8_t> bytes) {
    return ::sendto(fd_, bytes.data(), bytes.size(), 0, to.address(), to.size) ==
           static_cast<ssize_t>(bytes.size());
  }
  // Bytes taken; negative: none waits.
  ssize_t receive(std::span<std::uint8_t> buffer, DatagramPlace& from) {
    from.size = sizeof from.at;
    return ::recvfrom(fd_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from.at),
                      &from.size);
  }

 private:
  DatagramPlace place_;
  int fd_ = -1;
  bool good_ = false;
};

// Between a client, who sends to the front, and a server, who takes the back for the client.
// Forwards in a thread of its own; the client is whoever sent last.
class DatagramRelay {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Watch = std::function<void(bool to_server, std::span<const std::uint8_t> bytes)>;

  // `begin` is called once in the relay's thread, `watch` there before a datagram goes on.
  DatagramRelay(const DatagramPlace& front, const DatagramPlace& back, DatagramPlace server,
                Watch watch = {}, std::function<void()> begin = {})
      : watch_(std::move(watch)), front_(front), back_(back), server_(server) {
    thread_ = std::thread([this, begin = std::move(begin)] {
      if (begin) begin();
      run();
    });
  }
  ~DatagramRelay() {
    ends_ = true;
    thread_.join();
  }
  DatagramRelay(const DatagramRelay&) = delete;
  DatagramRelay& operator=(const DatagramRelay&) = delete;

  bool good() const { return front_.good() && back_.good(); }
  const DatagramPlace& front() const { return front_.place(); }
  // Where the client is; nowhere: it has not spoken yet.
  DatagramPlace client() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return client_;
  }

  // As if the client, or the server, had sent it. False: it was not taken.
  bool to_server(const Bytes& bytes) { return back_.send(server_, bytes); }
  bool to_client(const Bytes& bytes) { return front_.send(client(), bytes); }
  // The newest that passed, oldest first.
  std::vector<Bytes> seen(bool to_server) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto& from = seen_[to_server ? 1 : 0];
    return {from.begin(), from.end()};
  }

 private:
  static constexpr std::size_t kSeen = 400;  // datagrams kept each way
  static constexpr int kLook = 20;           // at the end of the relay [ms]

  void run() {
    std::array<pollfd, 2> ends{pollfd{front_.fd(), POLLIN, 0}, pollfd{back_.fd(), POLLIN, 0}};
    while (!ends_) {
      if (::poll(ends.data(), ends.size(), kLook) <= 0) continue;
      for (const bool to_server : {true, false}) take(to_server);
    }
  }

  void take(bool to_server) {
    std::array<std::uint8_t, 2048> buffer;
    for (DatagramPlace from;;) {
      const ssize_t n = (to_server ? front_ : back_).receive(buffer, from);
      if (n < 0) return;
      const std::span<const std::uint8_t> bytes(buffer.data(), static_cast<std::size_t>(n));
      if (watch_) watch_(to_server, bytes);
      if (to_server) {
        const std::lock_guard<std::mutex> lock(mutex_);
        client_ = from;
      }
      const DatagramPlace to = to_server ? server_ : client();
      if (to.size != 0) (void)(to_server ? back_ : front_).send(to, bytes);
      const std::lock_guard<std::mutex> lock(mutex_);
      auto& seen = seen_[to_server ? 1 : 0];
      if (seen.size() == kSeen) seen.pop_front();
      seen.emplace_back(bytes.begin(), bytes.end());
    }
  }

  const Watch watch_;
  PlacedSocket front_, back_;
  const DatagramPlace server_;
  mutable std::mutex mutex_;
  DatagramPlace client_;
  std::array<std::deque<Bytes>, 2> seen_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

// To a server at a port of this computer; the client sends to port().
class UdpRelay : public DatagramRelay {
 public:
  explicit UdpRelay(int server_port)
      : DatagramRelay(DatagramPlace(0), DatagramPlace(0), DatagramPlace(server_port)) {}
  int port() const { return front().port(); }
};

// To a slave at a path; its masters are told path(), which is beside it.
class LinkRelay : public DatagramRelay {
 public:
  explicit LinkRelay(const std::string& slave_path, Watch watch = {},
                     std::function<void()> begin = {})
      : DatagramRelay(DatagramPlace(slave_path + ".way"), DatagramPlace(slave_path + ".back"),
                      DatagramPlace(slave_path), std::move(watch), std::move(begin)),
        path_(slave_path + ".way") {}
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace handrail
