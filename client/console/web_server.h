// HTTP and WebSockets for a few people: every connection, its bytes and its times are bounded.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <utility>

#include <openssl/types.h>

#include "client/console/gateway/web.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// One request a connection, or a WebSocket (RFC 6455). Where there is no room for one more, one
// that is answered goes, or that has taken longest to say what it wants; each has a tenth of a
// second for it, and others wait. So whoever says it at once is served, whatever others do. A page
// that reads slowly misses frames (Outbox); one that does not take any for kSlow, or does not
// answer a ping, is let go. All methods in the thread that runs the io_context.
class WebServer final : public PageSink {
 public:
  // A thousand at once, and those that are inside.
  static constexpr std::size_t kMostConnections = 1200;
  static constexpr std::uint32_t kMostHeader = 8u << 10;  // [bytes]
  static constexpr std::uint32_t kMostFrame = 64u << 10;  // [bytes]
  static constexpr int kMostControls = 20;                // pings and pongs of a page in a second
  // TLS handshakes begun in a second, of all and of one network: others wait. One takes 0.4 ms.
  static constexpr std::size_t kMostHandshakes = 200, kMostHandshakesOfNetwork = 60;
  static constexpr Nanos kHeaderPatience = 5 * kSecond;  // from the connection to its whole head
  static constexpr Nanos kAnswerPatience = 5 * kSecond;  // for an answer to be taken
  static constexpr Nanos kIdle = 30 * kSecond;           // of a page; pinged after half of it
  static constexpr Nanos kSlow = 5 * kSecond;            // for one frame to be taken

  // Must outlive the server.
  explicit WebServer(boost::asio::io_context& io);
  ~WebServer() override;

  // Listens at an address of this computer or "any", for `application`, which must be there until
  // close(); over TLS where `tls` is not null. The error names the place and says what was
  // expected.
  Status open(const std::string& address, std::uint16_t port, WebApplication& application,
              std::shared_ptr<SSL_CTX> tls = nullptr);
  // Who calls from now on is shown these keys; who is connected stays. Where it is encrypted.
  void show(std::shared_ptr<SSL_CTX> tls);
  std::uint16_t port() const;
  // Ends everything. Safe to call twice.
  void close();

  void send(PageId page, SharedText frame, bool binary, FrameWorth worth) override;
  void end(PageId page, std::uint16_t code, const std::string& why) override;
  std::size_t connections() const;

 private:
  class Connection;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace handrail
