#include "tests/emulator/order_desk.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace handrail::emulator {
namespace {

constexpr std::size_t kLongestLine = 64 * 1024;  // [bytes]
constexpr int kWaiting = 8;

}  // namespace

OrderDesk::~OrderDesk() {
  for (const Client& client : clients_) {
    if (client.in > 2) ::close(client.in);
  }
  if (listening_ < 0) return;
  ::close(listening_);
  ::unlink(path_.c_str());
}

Status OrderDesk::open(const std::string& place) {
  if (place.empty()) return Status::ok();
  if (place == "-") {
    clients_.push_back({STDIN_FILENO, STDERR_FILENO, {}, false});
    return Status::ok();
  }
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (place.size() >= sizeof address.sun_path) {
    return Status::error(place + ": " + std::to_string(place.size()) +
                         " bytes, a socket's path has fewer than " +
                         std::to_string(sizeof address.sun_path));
  }
  std::memcpy(address.sun_path, place.c_str(), place.size());
  listening_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const mode_t before = ::umask(0177);
  const bool bound =
      ::bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::listen(listening_, kWaiting) == 0;
  const int error = errno;
  ::umask(before);
  if (bound) {
    path_ = place;
    return Status::ok();
  }
  ::close(listening_);
  listening_ = -1;
  return Status::error(place + ": cannot listen: " + std::generic_category().message(error));
}

std::vector<pollfd> OrderDesk::waits() const {
  std::vector<pollfd> out;
  if (listening_ >= 0) out.push_back({listening_, POLLIN, 0});
  for (const Client& client : clients_) out.push_back({client.in, POLLIN, 0});
  return out;
}

void OrderDesk::serve(const std::vector<pollfd>& came,
                      const std::function<std::string(const std::string& line)>& carry_out) {
  for (const pollfd& one : came) {
    if (one.revents == 0) continue;
    if (one.fd == listening_) {
      const int made = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
      if (made >= 0) clients_.push_back({made, made, {}, false});
      continue;
    }
    for (Client& client : clients_) {
      if (client.in == one.fd) take(client, carry_out);
    }
  }
  for (const Client& client : clients_) {
    if (client.gone && client.in > 2) ::close(client.in);
  }
  std::erase_if(clients_, [](const Client& client) { return client.gone; });
}

void OrderDesk::take(Client& client,
                     const std::function<std::string(const std::string& line)>& carry_out) {
  std::array<char, 4096> buffer{};
  const ssize_t size = ::read(client.in, buffer.data(), buffer.size());
  if (size <= 0) {
    client.gone = true;
    return;
  }
  client.begun.append(buffer.data(), static_cast<std::size_t>(size));
  for (std::size_t end; (end = client.begun.find('\n')) != std::string::npos;) {
    const std::string line = client.begun.substr(0, end);
    client.begun.erase(0, end + 1);
    if (line.empty()) continue;
    // Who does not read the answers does not hold the packets up.
    const std::string answer = carry_out(line) + "\n";
    const ssize_t written = ::write(client.out, answer.data(), answer.size());
    if (written != static_cast<ssize_t>(answer.size())) client.gone = true;
  }
  if (client.begun.size() > kLongestLine) client.gone = true;
}

}  // namespace handrail::emulator
