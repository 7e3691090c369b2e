// Both ends of the link, fed with each other's datagrams, damaged ones, strangers' and old ones, at
// any times. The input is a row of acts, each a byte and what it needs.
#include <optional>

#include "server/link/frame.h"
#include "server/link/peer.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

using fuzz::require;

struct Sent {
  bool to_slave = true;
  bool is_refusal = false;
  std::vector<std::uint8_t> bytes;
};

class Ends {
 public:
  explicit Ends(fuzz::Bytes bytes) : in_(bytes) {}

  void run() {
    const std::size_t most = fuzz::most_acts(in_.left());
    while (!in_.empty() && acts_ < most) {
      ++acts_;
      act(in_.take<std::uint8_t>() % 9);
      check(master_);
      check(slave_);
    }
  }

 private:
  static constexpr std::size_t kMostSent = 32;

  void act(int what) {
    switch (what) {
      case 0: now_ += Nanos{1} << in_.take<std::uint8_t>() % 36; break;  // up to a minute
      case 1: now_ += kMillisecond; break;
      case 2: speak(master_, sample_master(), true); break;
      case 3: speak(slave_, sample_slave(), false); break;
      case 4: deliver_own(); break;
      case 5: deliver_damaged(); break;
      case 6: deliver_stranger(); break;
      case 7: {
        const bool to_slave = (in_.take<std::uint8_t>() & 1) != 0;
        deliver(to_slave, in_.take_bytes(in_.take<std::uint8_t>()));
        break;
      }
      default: (in_.take<std::uint8_t>() & 1) != 0 ? master_.withhold(now_) : slave_.withhold(now_);
    }
  }

  template <typename Peer, typename State>
  void speak(Peer& peer, State state, bool to_slave) {
    std::vector<std::uint8_t> bytes(kMaxDatagram);
    state.stop_epoch += in_.take<std::uint8_t>() % 2;
    const std::size_t size = peer.poll(now_, state, bytes);
    require(size <= kMaxDatagram, "a datagram is no longer than it may be");
    bytes.resize(size);
    if (size != 0) remember({to_slave, false, bytes});
  }
  void remember(Sent sent) {
    if (sent_.size() == kMostSent) sent_.erase(sent_.begin());
    sent_.push_back(std::move(sent));
  }
  const Sent* any_sent() {
    const auto i = in_.take<std::uint8_t>();
    return sent_.empty() ? nullptr : &sent_[i % sent_.size()];
  }

  // As it was sent, however late and often: it can only be refused for its place in the order.
  void deliver_own() {
    const Sent* found = any_sent();
    if (found == nullptr) return;
    const Sent sent = *found;
    const Reject cause = deliver(sent.to_slave, sent.bytes);
    const bool in_order = cause == Reject::kNone || cause == Reject::kDuplicate ||
                          cause == Reject::kStale || cause == Reject::kSessionBusy ||
                          cause == Reject::kSessionRetired;
    require(sent.is_refusal ? cause == Reject::kRefused || cause == Reject::kStale : in_order,
            "what one end sends the other understands");
  }
  void deliver_damaged() {
    const Sent* found = any_sent();
    const auto at = in_.take<std::uint16_t>();
    const auto value = in_.take<std::uint8_t>();
    if (found == nullptr) return;
    Sent sent = *found;
    sent.bytes[at % sent.bytes.size()] = value;
    if (at % sent.bytes.size() >= kFrameBytes) {
      const DatagramKind kind = sent.is_refusal ? DatagramKind::kRefusal
                                : sent.to_slave ? DatagramKind::kMaster
                                                : DatagramKind::kSlave;
      seal_frame(kind, sent.bytes);
    }
    deliver((value & 0x40) == 0 ? sent.to_slave : !sent.to_slave, sent.bytes);
  }
  void deliver_stranger() {
    DatagramHeader header;
    header.session = std::uint64_t{in_.take<std::uint8_t>()} + 1;
    header.sequence = std::max<std::uint64_t>(in_.take<std::uint64_t>(), 1);
    header.sent = in_.take<Nanos>() & INT64_MAX;
    if ((header.sent & 1) != 0) {
      header.echo_session = (header.sent & 2) != 0 ? slave_.session() : master_.session();
      header.echo_sequence = std::max<std::uint64_t>(in_.take<std::uint64_t>(), 1);
      header.echo_sent = in_.take<Nanos>() & INT64_MAX;
      header.echo_held = in_.take<Nanos>() & INT64_MAX;
    }
    const bool to_slave = (header.sent & 4) != 0;
    deliver(to_slave,
            to_slave ? encoded(header, sample_master()) : encoded(header, sample_slave()));
  }
  // By one codec for all inputs: to make one takes longer than all else that a stranger does.
  template <typename State>
  static std::vector<std::uint8_t> encoded(const DatagramHeader& header, const State& state) {
    static Codec codec;
    std::vector<std::uint8_t> bytes(kMaxDatagram);
    Reject cause = Reject::kNone;
    bytes.resize(codec.encode(header, state, bytes, cause));
    return bytes;
  }

  Reject deliver(bool to_slave, fuzz::Bytes bytes) {
    return to_slave ? deliver_to(slave_, bytes) : deliver_to(master_, bytes);
  }
  // What is refused changes nothing; what is accepted is newer.
  template <typename Peer>
  Reject deliver_to(Peer& peer, fuzz::Bytes bytes) {
    const LinkSnapshot before = peer.snapshot();
    const Reject cause = peer.on_datagram(bytes, now_);
    const LinkSnapshot& after = peer.snapshot();
    require(after.accepted + after.rejected == before.accepted + before.rejected + 1,
            "every datagram is counted once");
    if (cause == Reject::kNone) {
      require(after.received_at == now_, "an accepted datagram is of now");
      require(after.peer_epoch != before.peer_epoch || after.sequence > before.sequence,
              "within a session sequences rise");
    } else {
      require(after.received_at == before.received_at && after.sequence == before.sequence &&
                  after.peer_epoch == before.peer_epoch,
              "a refused datagram moves no state and no age");
    }
    std::array<std::uint8_t, kMaxDatagram> out;
    const std::size_t size = peer.refuse(cause, "process 4711 on this computer", now_, out);
    require(size == 0 || size < bytes.size(), "a refusal is shorter than what it answers");
    if (size != 0) remember({false, true, {out.begin(), out.begin() + size}});
    return cause;
  }

  template <typename Peer>
  void check(const Peer& peer) {
    const LinkSnapshot& s = peer.snapshot();
    require(s.received_of_100 >= 0 && s.received_of_100 <= 100, "received of 100 is 0 to 100");
    require(s.peer_received_of_100 >= 0 && s.peer_received_of_100 <= 100, "and as the peer says");
    require(s.loss_share >= 0.0 && s.loss_share <= 1.0, "the loss is a share");
    require(s.round_trip >= -1, "no answer comes before its question");
    require(s.age(now_) >= 0 && s.loop_age(now_) >= 0, "nothing is of the future");
    require(peer.wait_time(now_) >= 0, "nothing was due in the past");
    (void)s.view(now_);
  }

  fuzz::Input in_;
  std::size_t acts_ = 0;
  Nanos now_ = 1000 * kSecond;
  MasterPeer master_{1000};
  SlavePeer slave_{2000};
  std::vector<Sent> sent_;
};

}  // namespace

HANDRAIL_FUZZ(peer) { Ends(bytes).run(); }

}  // namespace handrail
