// The calling end of the encrypted link: a master's.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/time.h"
#include "server/link/secure/dtls_channel.h"
#include "server/link/transport.h"

namespace handrail {

// Makes a session with one of the addresses it is told, and another one when it is not answered any
// more, or when this side or the other has a newer key than the session's; the old one serves until
// the new one is open. One thread at a time.
class SecureClient final : public Transport {
 public:
  // What is sent and not answered for so long calls for another session: then the other side has
  // closed ours (proto/WIRE.md, ages). One that has never answered may be as far away as kFarthest.
  static constexpr Nanos kUnanswered = kSecond;
  // An attempt that nobody answers is over after so long, so that the next address is tried; twice
  // as long once all were, up to kFarthest, for who is far away. One that is answered is over after
  // so long without more of it. By the caller's clock: OpenSSL's is the calendar, and may leap.
  static constexpr Nanos kFirstPatience = kSecond;
  // The longest round trip over which there is a session, with something to spare: the link is for
  // half of it (server/lab/RESULTS.md).
  static constexpr Nanos kFarthest = 4 * kSecond;
  // After a refusal, which only a person can change.
  static constexpr Nanos kRefusedPause = kSecond;
  // How often a newer key is tried beside a session that serves. Chosen: who has typed the line at
  // the other side sees the change as quickly, and a handshake costs the slave 0.34 ms.
  static constexpr Nanos kNewerKeyPause = 10 * kSecond;

  struct Counts {
    std::uint64_t sessions = 0;   // opened
    std::uint64_t attempts = 0;   // handshakes begun
    std::uint64_t strangers = 0;  // datagrams of no session and no handshake, forged or repeated
  };

  SecureClient(SecureContext& context, DatagramSocket& socket)
      : context_(context), socket_(socket) {}

  // Where the other side is, one after the other is tried; empty: nobody is called.
  void set_addresses(std::vector<Address> addresses) { addresses_ = std::move(addresses); }
  void set_trusted(TrustList trusted);
  // Our key, and the one that is to take its place: it is tried beside a session that serves, and
  // where the present one is refused.
  Status set_own(const OwnKey& key, const std::optional<OwnKey>& next);
  // The keys of the session, once for each that has brought something: whatever the other side
  // sends goes by it.
  std::optional<SessionKeys> take_begun() noexcept { return std::exchange(begun_, std::nullopt); }
  // Call every millisecond or so.
  void tick(Nanos now) noexcept;

  std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override;
  void adopt_sender() noexcept override {}
  bool send(std::span<const std::uint8_t> bytes) noexcept override;
  bool answer(std::span<const std::uint8_t>) noexcept override { return false; }
  std::string_view peer_name() const noexcept override;

  // Nobody answers, and somebody is looked for: there is no session, or not any more.
  bool calls() const noexcept;
  const Counts& counts() const noexcept { return counts_; }
  // The session; null: none is open.
  const DtlsChannel* session() const noexcept { return session_.get(); }
  Nanos session_since() const noexcept { return since_; }
  // Why attempts fail; kNone: none has since a session opened. One that got no answer says less
  // than one before that was refused: an alert may be lost.
  DtlsChannel::Problem problem() const noexcept { return problem_; }
  // The key that the last refused other side has shown.
  const PeerKey& refused() const noexcept { return refused_; }
  const Address& tried() const noexcept { return tried_; }

 private:
  void begin(bool calling) noexcept;
  // This side or the other has a newer key than the session's.
  bool wants_newer() const noexcept;
  Nanos patience() const noexcept;
  void settle() noexcept;  // what became of the attempt
  void failed(DtlsChannel::Problem problem) noexcept;

  SecureContext& context_;
  DatagramSocket& socket_;
  std::vector<Address> addresses_;
  std::size_t next_address_ = 0;
  std::unique_ptr<DtlsChannel> session_, attempt_;
  // The session before, for what the other side sends until it has heard of the new one.
  std::unique_ptr<DtlsChannel> before_;
  std::array<std::uint8_t, 2048> wire_{};
  Nanos now_ = 0;
  Nanos since_ = 0;
  Nanos heard_ = 0;          // of the attempt, or when it began
  bool answered_ = false;    // the attempt
  bool serves_ = false;      // the session has answered what was sent
  std::size_t silent_ = 0;   // attempts in a row that nobody answered
  Nanos asking_ = kForever;  // since when what was sent has not been answered
  Nanos not_before_ = -kForever;
  DtlsChannel::Problem problem_ = DtlsChannel::Problem::kNone;
  bool unanswered_ = false;     // the last attempt got no answer
  bool beside_ = false;         // the attempt is one for newer keys, beside the session
  bool try_next_ = false;       // call with our next key: the present one was refused
  Nanos newer_at_ = -kForever;  // not before
  std::optional<SessionKeys> begun_;
  PeerKey refused_;
  Address tried_;
  Counts counts_;
};

}  // namespace handrail
