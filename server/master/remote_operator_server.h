// Operators on other computers: TLS 1.3 over TCP, for keys in the list of the trusted.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Boost 1.74 uses std::exchange without including it.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include "server/base/status.h"
#include "server/base/time.h"
#include "server/link/secure/secure_context.h"
#include "server/link/secure/secure_transport.h"
#include "server/master/operator_server.h"

namespace handrail {

struct RemoteOperatorOptions {
  SecureLinkOptions keys;
  std::string address;  // "any", or one of this computer
  std::uint16_t port = 0;
};

// Who shows the key of an operator or an observer is handed to the OperatorServer as a connection
// of its own, and nobody else is. What strangers can use up is bounded: how many wait, of them
// those from one network, and handshakes in a second, in which each network has its turn. Where
// there is no room for one more session, observers go before operators, and of each kind who said
// nothing for longest. All methods in the IO thread or while it does not run.
class RemoteOperatorServer {
 public:
  // A desk has a handful of people, each with a command or two at a time.
  static constexpr std::size_t kMostSessions = 64;
  // That have not shown a key yet, in all and from one network (an IPv4 address, or the first half
  // of an IPv6 one). One more takes the place of the oldest. Each holds a descriptor and 9 KiB.
  static constexpr std::size_t kMostStrangers = 256, kMostOfOneNetwork = 16;
  // A handshake, its session and a request take 1.0 ms of the thread that serves the link
  // (measured, mean of 150), in pieces: so one fiftieth of it. At most one begins in a tick.
  static constexpr int kHandshakesPerSecond = 20;
  // In a tick; each takes 19 us of that thread (measured, mean of 20 000, garbage refused).
  static constexpr int kMostAccepted = 4;
  // For a handshake from the connection on, for what is answered to be taken, and for the end.
  static constexpr Nanos kPatience = 2 * kSecond;

  // Both must outlive the server.
  RemoteOperatorServer(boost::asio::io_context& io, OperatorServer& operators);
  ~RemoteOperatorServer();

  // Listens; the error names the place and says what was expected.
  Status open(const RemoteOperatorOptions& options);
  // "any:47003"; empty while closed.
  std::string place() const;
  using Say = std::function<void(bool bad, const std::string& line)>;
  void on_say(Say say) { say_ = std::move(say); }
  // A thousand times a second: accepts, begins handshakes, ends what takes too long, takes news of
  // the list of the trusted, whose removed or changed entries end their connections. May throw
  // std::bad_alloc.
  void tick(Nanos now);
  // Ends all connections. Safe to call twice.
  void close();
  // That have shown their key.
  std::size_t sessions() const;

 private:
  class Session;
  void accept();
  // Of one that has sent its hello, if its network's turn has come.
  void begin_handshake();
  void take_trusted(const TrustList& trusted);
  // Ends the one needed least of those that it `counts`, if there are `most` of them.
  template <typename Counts>
  void make_room(std::size_t most, Counts counts);
  void refused(const Session& session);
  void say_trusted() const;
  void say(bool bad, const std::string& line) const {
    if (say_) say_(bad, line);
  }

  const KeyChange changes_{
      [this](bool bad, const std::string& line) { say(bad, "operators: " + line); },
      [this](const OwnEntry& own) { return keys_->set_own(own.key, own.next); },
      [this](const TrustList& trusted) { take_trusted(trusted); }};
  OperatorServer& operators_;
  boost::asio::ip::tcp::acceptor acceptor_;
  RemoteOperatorOptions options_;
  std::unique_ptr<SecureContext> keys_;
  std::unique_ptr<boost::asio::ssl::context> tls_;
  Say say_;
  std::vector<std::shared_ptr<Session>> sessions_;
  std::vector<Address> handshakes_;  // begun in this second, from where
  Nanos refill_ = 0;                 // when the next begins
  Nanos next_line_ = 0;              // about strangers
};

}  // namespace handrail
