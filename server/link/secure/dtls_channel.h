// One encrypted session, or the making of one. Datagrams come in; what they hold comes out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <openssl/types.h>

#include "server/base/time.h"
#include "server/link/secure/datagram_socket.h"
#include "server/link/secure/record_opener.h"
#include "server/link/secure/secure_context.h"

namespace handrail {

// An open channel allocates nothing for a datagram that it opens or seals. It sends by the socket
// itself, to address(). One thread at a time; context and socket must outlive it.
class DtlsChannel {
 public:
  enum class State : std::uint8_t {
    kListening,  // server: nothing is known of anybody
    kHandshake,
    kOpen,
    kClosed,  // by either side, or refused: see problem()
  };
  // Why a channel is closed.
  enum class Problem : std::uint8_t {
    kNone,        // closed in order
    kUntrusted,   // the other side's key is not in our list with its role
    kWeAre,       // the other side does not trust our key
    kNoAnswer,    // retransmitted as often as DTLS does
    kNoAgreement  // anything else: another protocol, another version, broken bytes
  };
  // A flight that is not answered is sent again after so long, in place of DTLS's second: at 30 %
  // loss each way 19 of 20 handshakes then take less than one second (secure_link_test). After some
  // of these it waits twice as long each time: OpenSSL gives up after twelve, which so are 5 s, and
  // a longer round trip costs datagrams, not the handshake.
  static constexpr Nanos kRetransmit = 50 * kMillisecond;
  static constexpr unsigned kQuickRetransmits = 6;
  static constexpr Nanos kSlowestRetransmit = 1600 * kMillisecond;

  // A client begins with the first tick(), a server by listen(). Null: there is no memory.
  // `own`: which of our keys a client shows; a server shows the one that it is asked for.
  static std::unique_ptr<DtlsChannel> make(
      const SecureContext& context, DatagramSocket& socket, const Address& peer,
      SecureContext::Own own = SecureContext::Own::kKey) noexcept;
  DtlsChannel(const SecureContext& context, DatagramSocket& socket, const Address& peer,
              SecureContext::Own own) noexcept;
  ~DtlsChannel();
  DtlsChannel(const DtlsChannel&) = delete;
  DtlsChannel& operator=(const DtlsChannel&) = delete;

  // Listening: looks at one datagram of `from`. True when it proves that its sender receives there;
  // the channel is its handshake then. Else the sender may have been sent a cookie, which is
  // smaller than what it sent, and nothing is kept.
  bool listen(std::span<const std::uint8_t> datagram, const Address& from) noexcept;

  // Takes one datagram of `from`, and returns how many bytes of `plain` it held; 0: none, or they
  // were not the other side's, came before, or are too late for the link too.
  std::size_t take(std::span<const std::uint8_t> datagram, const Address& from,
                   std::span<std::uint8_t> plain) noexcept;
  // False: it is not open, or the socket did not take it.
  bool send(std::span<const std::uint8_t> plain) noexcept;
  // What the handshake sends again. Call every few milliseconds.
  void tick() noexcept;
  // Tells the other side, if it is open.
  void close() noexcept;
  // The other side is where the datagram that was opened last came from.
  void move_to_sender() noexcept { attached_.address = from_; }

  State state() const noexcept { return state_; }
  Problem problem() const noexcept { return problem_; }
  const PeerKey& peer() const noexcept { return attached_.peer; }
  // The key of ours that it shows.
  const PublicKey& own() const noexcept { return attached_.own; }
  const Address& address() const noexcept { return attached_.address; }

 private:
  friend struct DtlsWire;

  void go_on() noexcept;          // with the handshake
  void end(int result) noexcept;  // of an operation that failed for good

  const SecureContext& context_;
  DatagramSocket& socket_;
  SSL* ssl_ = nullptr;
  State state_ = State::kClosed;
  Problem problem_ = Problem::kNone;
  SecureContext::Attached attached_;
  Address from_;
  RecordOpener opener_;
  std::span<const std::uint8_t> waiting_;  // the datagram that OpenSSL is to read
  bool peek_ = false;                      // ... and to leave where it is
  bool sent_ = false;                      // the socket took what was written last
};

}  // namespace handrail
