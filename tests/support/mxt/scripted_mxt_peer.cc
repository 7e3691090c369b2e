#include "tests/support/mxt/scripted_mxt_peer.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

namespace handrail::test {
namespace {

constexpr int kPatienceMs = 20'000;  // for a packet the script expects

std::string hex(const golden::Packet& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = std::to_string(bytes.size()) + " bytes:";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i % 4 == 0) text += ' ';
    text += kDigits[bytes[i] >> 4];
    text += kDigits[bytes[i] & 15];
  }
  return text;
}

}  // namespace

ScriptedMxtPeer::ScriptedMxtPeer() {
  socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  const bool bound = socket_ >= 0 && ::bind(socket_, generic, length) == 0 &&
                     ::getsockname(socket_, generic, &length) == 0;
  if (!bound) failures_.push_back("cannot bind a loopback port");
  port_ = ntohs(address.sin_port);
}

ScriptedMxtPeer::~ScriptedMxtPeer() {
  finish();
  ::close(socket_);
}

ScriptedMxtPeer& ScriptedMxtPeer::expect(golden::Packet bytes) {
  script_.push_back({Kind::kExpect, std::move(bytes)});
  return *this;
}

ScriptedMxtPeer& ScriptedMxtPeer::reply(golden::Packet bytes) {
  script_.push_back({Kind::kReply, std::move(bytes)});
  return *this;
}

ScriptedMxtPeer& ScriptedMxtPeer::ignore_the_rest() {
  script_.push_back({Kind::kIgnore, {}});
  return *this;
}

void ScriptedMxtPeer::play() {
  played_ = true;
  thread_ = std::thread([this] { run(); });
}

void ScriptedMxtPeer::finish() {
  if (finished_) return;
  finished_ = true;
  if (thread_.joinable()) thread_.join();
  if (!played_) failures_.push_back("the script was never played");
  const bool ignores = !script_.empty() && script_.back().kind == Kind::kIgnore;
  std::array<std::uint8_t, 512> buffer;
  // Loopback delivers within the sender's call: what was sent before now is here.
  for (ssize_t n;
       !ignores && (n = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) >= 0;) {
    failures_.push_back("left unread: " + hex({buffer.begin(), buffer.begin() + n}));
  }
  for (const std::string& failure : failures_) ADD_FAILURE() << "scripted peer: " << failure;
}

void ScriptedMxtPeer::fail(std::size_t step, const std::string& what) {
  failures_.push_back("step " + std::to_string(step + 1) + " of " + std::to_string(script_.size()) +
                      ": " + what);
}

void ScriptedMxtPeer::run() {
  sockaddr_in from{};
  socklen_t length = sizeof(from);
  std::array<std::uint8_t, 512> buffer;
  for (std::size_t i = 0; i < script_.size(); ++i) {
    const Step& step = script_[i];
    if (step.kind == Kind::kIgnore) return;
    if (step.kind == Kind::kReply) {
      ::sendto(socket_, step.bytes.data(), step.bytes.size(), 0,
               reinterpret_cast<const sockaddr*>(&from), length);
      continue;
    }
    pollfd entry{socket_, POLLIN, 0};
    if (::poll(&entry, 1, kPatienceMs) <= 0)
      return fail(i, "nothing came; expected " + hex(step.bytes));
    const ssize_t n = ::recvfrom(socket_, buffer.data(), buffer.size(), 0,
                                 reinterpret_cast<sockaddr*>(&from), &length);
    const golden::Packet got(buffer.begin(), buffer.begin() + std::max<ssize_t>(n, 0));
    if (got != step.bytes) return fail(i, "got " + hex(got) + "\n expected " + hex(step.bytes));
  }
}

}  // namespace handrail::test
