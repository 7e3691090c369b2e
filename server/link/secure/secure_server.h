// The listening end of the encrypted link: a slave's.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "server/base/time.h"
#include "server/link/secure/dtls_channel.h"
#include "server/link/transport.h"

namespace handrail {

// Holds a few sessions, of which the peer that was adopted leads. A session is where its newest
// datagram that the link accepted came from: a peer that changes its address, or whose NAT does,
// goes on. Nothing is kept for who has not shown that it receives at its address. What is not of a
// session is dropped, and answered by a cookie at most, which is smaller. One thread at a time.
class SecureServer final : public Transport {
 public:
  // A handshake that takes longer is over: a round trip and what is lost of it. By the caller's
  // clock: OpenSSL's is the calendar, and may leap.
  static constexpr Nanos kLongestHandshake = 4 * kSecond;
  // Sessions and handshakes at a time: one that leads, one that takes its place, and some that are
  // told so. Chosen; a datagram of nobody is tried with each, a microsecond for one.
  static constexpr int kSlots = 8;
  // Of each in a second, above which strangers wait. A handshake takes 0.34 ms of the thread that
  // serves the link, a cookie 5 us at most (measured, tests/README.md): so 12 ms of a second.
  static constexpr int kHandshakesPerSecond = 20, kCookiesPerSecond = 1000;

  struct Counts {
    std::uint64_t sessions = 0;    // opened
    std::uint64_t untrusted = 0;   // handshakes that ended at the key
    std::uint64_t failed = 0;      // ... at anything else
    std::uint64_t strangers = 0;   // datagrams of no session and no handshake, forged or repeated
    std::uint64_t over_limit = 0;  // of strangers that had to wait
  };
  // Who came last and was not let in.
  struct Refused {
    Nanos at = -kForever;
    Address from;
    PeerKey peer;
    DtlsChannel::Problem problem = DtlsChannel::Problem::kNone;
  };

  SecureServer(SecureContext& context, DatagramSocket& socket)
      : context_(context), socket_(socket) {}

  // Timers of handshakes. Call every millisecond or so.
  void tick(Nanos now) noexcept;
  // Sessions whose key is not in it any more end at once.
  void set_trusted(TrustList trusted);
  // For handshakes from now on: sessions go on.
  Status set_own(const OwnKey& key, const std::optional<OwnKey>& next) {
    return context_.set_own(key, next);
  }
  // The keys of the session that leads, once for each: whatever the other side sends goes by it.
  std::optional<SessionKeys> take_begun() noexcept;

  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override;
  void adopt_sender() noexcept override;
  bool send(std::span<const std::uint8_t> bytes) noexcept override;
  bool answer(std::span<const std::uint8_t> bytes) noexcept override;
  std::string_view peer_name() const noexcept override;

  const Counts& counts() const noexcept { return counts_; }
  const Refused& refused() const noexcept { return refused_; }
  // The session that leads; null: none.
  const DtlsChannel* leader() const noexcept;
  // Since when, by tick()'s clock.
  Nanos leader_since() const noexcept;

 private:
  struct Slot {
    std::unique_ptr<DtlsChannel> channel;
    std::array<std::uint8_t, 32> random{};  // of its ClientHello
    Nanos since = 0;
    Nanos heard = 0;
    bool opened = false;  // counted as a session
    bool told = false;    // by take_begun()
    bool open() const noexcept {
      return channel != nullptr && channel->state() == DtlsChannel::State::kOpen;
    }
  };
  // What is taken from a full allowance that grows with time.
  struct Allowance {
    int left = 0;
    bool take() noexcept { return left > 0 && left-- > 0; }
  };

  // The one made last of those at `from` that `fits`; null: none.
  template <typename Fits>
  Slot* newest_at(const Address& from, Fits fits) noexcept;
  Arrival give(Slot& slot, std::span<const std::uint8_t> bytes, const Address& from,
               std::span<std::uint8_t> buffer) noexcept;
  Arrival greet(std::span<const std::uint8_t> bytes, const Address& from) noexcept;
  Arrival stranger() noexcept;
  void settle(Slot& slot) noexcept;
  Slot* room() noexcept;

  SecureContext& context_;
  DatagramSocket& socket_;
  std::array<Slot, kSlots> slots_;
  std::unique_ptr<DtlsChannel> listener_;
  Slot* leader_ = nullptr;
  Slot* last_ = nullptr;  // of the datagram received last; null: none of a session
  std::array<std::uint8_t, 2048> wire_{};
  Nanos now_ = 0;
  Nanos refill_ = 0;
  Allowance handshakes_, cookies_;
  Counts counts_;
  Refused refused_;
};

}  // namespace handrail
