// What carries datagrams to the one peer and back: sockets, or a network made up by a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/base/status.h"
#include "server/base/time.h"

namespace boost::asio {
class io_context;
}

namespace handrail {

// Never waits. One thread at a time.
class Transport {
 public:
  struct Arrival {
    std::size_t size = 0;    // up to the buffer's size; a longer datagram is cut
    bool from_peer = false;  // false: from one who cannot be the peer; drop it
    bool handled = false;    // the transport's own: nothing for the link
  };

  virtual ~Transport() = default;
  // Takes the datagram that has waited longest; nothing when none waits. Real-time safe.
  virtual std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept = 0;
  // Where the peer is not given, it is henceforth who sent the last received datagram. Call for
  // accepted datagrams only. Real-time safe.
  virtual void adopt_sender() noexcept = 0;
  // False when the datagram was not sent, which is one lost datagram, or when no peer is known yet.
  // Real-time safe.
  virtual bool send(std::span<const std::uint8_t> bytes) noexcept = 0;
  // To who sent the last received datagram, if that may be a peer. Real-time safe.
  virtual bool answer(std::span<const std::uint8_t> bytes) noexcept = 0;
  // Who the peer is, such as "process 4711 on this computer": a leader's name as in refusal.h;
  // empty: not known, or it has none. Holds until the peer changes. Real-time safe.
  virtual std::string_view peer_name() const noexcept = 0;
};

// Who is at the other end, as far as keys say.
struct LinkIdentity {
  bool encrypted = false;
  std::string name;     // of the peer, in our list of the trusted; empty: no session
  std::string key_id;   // of its key
  std::string address;  // where it is, or is looked for
  Nanos age = 0;        // of the session
  std::string problem;  // why there is no session, and what to do; empty: nothing is known
  std::string next;     // its end: what to do alone
};

// One that a daemon serves in its IO thread.
class ServedTransport : public Transport {
 public:
  // Takes its place. The error names it and says what was expected.
  virtual Status open() = 0;
  // Calls `readable` in the thread of the io_context each time datagrams may wait, until close().
  // `readable` must take all of them.
  virtual void on_readable(std::function<void()> readable) = 0;
  virtual void close() noexcept = 0;
  // To be called a thousand times a second. May need memory: throws std::bad_alloc.
  virtual void tick(Nanos /*now*/) {}
  // A line for the log; `bad`: somebody should look.
  using Say = std::function<void(bool bad, const std::string& line)>;
  virtual void on_say(Say /*say*/) {}
  // Not real-time safe.
  virtual LinkIdentity identity(Nanos /*now*/) const { return {}; }
  // Where it is, for who started the daemon; empty while closed.
  virtual std::string place() const = 0;
};

// Makes one that is served by `io`, which must outlive it. Closed.
using TransportMaker = std::function<std::unique_ptr<ServedTransport>(boost::asio::io_context& io)>;

}  // namespace handrail
