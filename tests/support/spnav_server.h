// A stand-in for spacenavd that writes its protocol's bytes by hand.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>
#include <thread>

namespace handrail::test {

using SpnavWords = std::array<std::int32_t, 8>;

inline SpnavWords spnav_motion(std::array<std::int32_t, 6> counts) {
  return {0, counts[0], counts[1], counts[2], counts[3], counts[4], counts[5], 8};
}
inline SpnavWords spnav_button(int number, bool down) { return {down ? 1 : 2, number, down}; }
inline SpnavWords spnav_device(bool added) { return {3, added ? 0 : 1, 7, 0x206, 0x46d, 0xc626}; }

// Serves one client at a time, in the caller's thread.
class SpnavServer {
 public:
  explicit SpnavServer(std::string path) : path_(std::move(path)) { listen(); }
  ~SpnavServer() { end(); }
  SpnavServer(const SpnavServer&) = delete;
  SpnavServer& operator=(const SpnavServer&) = delete;

  const std::string& path() const { return path_; }
  void listen() {
    end();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.data(), path_.size());
    ::unlink(path_.c_str());
    listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    works_ = ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
             ::listen(listener_, 8) == 0;
  }
  // The daemon ends: client and listener are gone.
  void end() {
    drop();
    if (listener_ >= 0) ::close(listener_);
    listener_ = -1;
    ::unlink(path_.c_str());
  }
  void drop() {
    if (client_ >= 0) ::close(client_);
    client_ = -1;
  }
  // Takes the next client, and the word with which it asks for a protocol; 0: none came in time.
  std::uint32_t accept(int patience_ms = 5000) {
    drop();
    pollfd waits{listener_, POLLIN, 0};
    if (::poll(&waits, 1, patience_ms) != 1) return 0;
    client_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    std::uint32_t word = 0;
    pollfd says{client_, POLLIN, 0};
    if (::poll(&says, 1, patience_ms) != 1) return 0;
    return ::read(client_, &word, sizeof word) == sizeof word ? word : 0;
  }
  void send(const void* bytes, std::size_t size) const {
    (void)!::send(client_, bytes, size, MSG_NOSIGNAL);
  }
  void send(const SpnavWords& words) const { send(words.data(), sizeof words); }
  void answer(std::uint32_t word) const { send(&word, sizeof word); }
  bool works() const { return works_; }

 private:
  std::string path_;
  int listener_ = -1, client_ = -1;
  bool works_ = false;
};

}  // namespace handrail::test
