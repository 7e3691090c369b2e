// The simulated controller's switches on the network: a few connections over TCP.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>

#include "devices/rig/network.h"
#include "server/base/status.h"

namespace handrail {

// Runs in the thread of `io`. What one read gives is one order, as nothing ends it. An answer that
// the other end does not take is dropped with its connection: nobody waits.
class SwitchesServer {
 public:
  struct Told {
    // The answer to an order; empty: none is sent.
    std::function<std::string(std::string_view order, PeerId peer)> answer;
    std::function<void(PeerId peer)> left;
  };

  SwitchesServer(boost::asio::io_context& io, Told told);
  ~SwitchesServer();
  SwitchesServer(const SwitchesServer&) = delete;
  SwitchesServer& operator=(const SwitchesServer&) = delete;

  // Listens at an IPv4 address; port 0 takes any free one. The error names both and the cause.
  Status open(const std::string& address, std::uint16_t port);
  // 0: it does not listen.
  std::uint16_t port() const;

  static constexpr int kMostConnections = 8;
  static constexpr std::size_t kMostOrder = 256;  // [bytes]

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace handrail
