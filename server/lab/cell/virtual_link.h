// A network made up from a seed: two ways of datagrams in virtual time, each with its own faults.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/base/random.h"
#include "server/base/time.h"
#include "server/link/codec.h"
#include "server/link/transport.h"

namespace handrail {

// What one way does to its datagrams. Shares are 0 to 1. Burst loss is Gilbert and Elliott's: per
// datagram the way turns bad with `burst_enter` and good with `burst_leave`; a bad one loses all.
struct LinkFaults {
  Nanos delay = 0;
  Nanos jitter = 0;  // delay is uniform within +-jitter, never below 0
  double loss = 0.0;
  double burst_enter = 0.0;
  double burst_leave = 1.0;
  double duplicate = 0.0;  // comes once more, after a delay of its own
  double reorder = 0.0;    // may overtake and be overtaken, `reorder_by` later; the rest keep order
  Nanos reorder_by = 0;
  double replay = 0.0;        // earlier datagrams sent again for each new one; may exceed 1
  double corrupt = 0.0;       // with 1 to 8 bits flipped
  std::int64_t rate_bps = 0;  // 0: without limit; headers of 28 bytes count
  Nanos queue = kSecond;      // what waits longer for the rate is dropped
};

// What a way has done so far.
struct WayCounters {
  std::uint64_t sent = 0;   // by the program, so also the number of the last one, from 1
  std::uint64_t lost = 0;   // loss, bursts, full queues
  std::uint64_t extra = 0;  // duplicates and replays put on the way
  std::uint64_t corrupted = 0;
  std::uint64_t delivered = 0;  // taken by the receiving program
};

// A datagram that the receiving program took.
struct Delivery {
  std::uint64_t number = 0;  // rank among the datagrams of the sending side, from 1
  bool authentic = true;     // the bytes are those that were sent
  Nanos at = 0;
};

// One way. Datagrams under way are ordered by arrival, then by sending. Receivers have a queue of
// kSocketQueue datagrams like a socket's: full, it drops what comes. Memory is taken at
// construction; all calls are real-time safe.
class LinkWay {
 public:
  static constexpr std::size_t kUnderWay = 4096;  // more are dropped
  static constexpr std::size_t kSocketQueue = 256;
  static constexpr std::size_t kHistory = 4096;  // datagrams a replay draws from

  explicit LinkWay(std::uint64_t seed);

  LinkFaults faults;

  void send(std::span<const std::uint8_t> bytes, Nanos now) noexcept;
  // Somebody else's datagram, arriving at once.
  void inject(std::span<const std::uint8_t> bytes, Nanos now) noexcept;
  // Moves what arrives by `now` into the receiver's queue.
  void advance(Nanos now) noexcept;
  // When the next datagram arrives; kForever if none is under way.
  Nanos next_due() const noexcept;
  // Takes the oldest in the queue; 0 = none waits. Longer than `out` is cut.
  std::size_t receive(std::span<std::uint8_t> out, Nanos now) noexcept;
  // Throws away what waits in the queue: the receiving program has died.
  void flush() noexcept;

  // The bytes of the datagram sent last; empty: none yet.
  std::span<const std::uint8_t> newest() const noexcept;

  const WayCounters& counters() const noexcept { return counters_; }
  // What was taken since the last clear_deliveries().
  std::span<const Delivery> deliveries() const noexcept { return {taken_.data(), taken_count_}; }
  void clear_deliveries() noexcept { taken_count_ = 0; }

 private:
  struct Datagram {
    std::array<std::uint8_t, kMaxDatagram> bytes;
    std::size_t size = 0;
    std::uint64_t number = 0;
    bool authentic = true;
  };
  struct Flight {
    Nanos due = 0;
    std::uint64_t order = 0;
    std::uint32_t slot = 0;
  };
  static bool later(const Flight& a, const Flight& b) noexcept {
    return a.due != b.due ? a.due > b.due : a.order > b.order;
  }

  Nanos travel(double draw) const noexcept;
  void launch(const Datagram& datagram, Nanos due) noexcept;
  void replay(Nanos now) noexcept;
  void remember(const Datagram& datagram) noexcept;
  bool flip_bits(Datagram& datagram) noexcept;

  Random random_;         // draws the same number for every datagram sent
  Random replay_random_;  // of their own, so that they do not deal the others anew
  Random bit_random_;
  bool bad_ = false;        // of the burst model
  Nanos last_due_ = 0;      // of those that keep their order
  Nanos rate_free_at_ = 0;  // when the rate has passed on all before
  std::vector<Datagram> slots_;
  std::vector<std::uint32_t> free_;
  std::vector<Flight> flights_;  // heap, earliest first
  std::array<std::uint32_t, kSocketQueue> queue_{};
  std::size_t first_ = 0;
  std::size_t queued_ = 0;
  std::vector<Datagram> history_;
  std::uint64_t remembered_ = 0;
  std::uint64_t launched_ = 0;
  std::array<Delivery, 2 * kSocketQueue> taken_{};
  std::size_t taken_count_ = 0;
  WayCounters counters_;
};

// Both ways and the two transports at their ends. Same seed, same calls: same bytes at the same
// times. at() moves time, which never goes backward.
class VirtualLink {
 public:
  explicit VirtualLink(std::uint64_t seed);
  VirtualLink(const VirtualLink&) = delete;
  VirtualLink& operator=(const VirtualLink&) = delete;

  void at(Nanos now) noexcept;
  // When the next datagram arrives at either end; kForever if none is under way.
  Nanos next_due() const noexcept;

  Transport& master() noexcept { return master_; }
  Transport& slave() noexcept { return slave_; }
  LinkWay& to_slave() noexcept { return to_slave_; }
  LinkWay& to_master() noexcept { return to_master_; }

 private:
  class End final : public Transport {
   public:
    End(LinkWay& in, LinkWay& out, const Nanos& now) : in_(in), out_(out), now_(now) {}
    std::optional<Arrival> receive(std::span<std::uint8_t> buffer) noexcept override;
    void adopt_sender() noexcept override {}
    bool send(std::span<const std::uint8_t> bytes) noexcept override;
    bool answer(std::span<const std::uint8_t>) noexcept override { return false; }
    std::string_view peer_name() const noexcept override { return {}; }

   private:
    LinkWay& in_;
    LinkWay& out_;
    const Nanos& now_;
  };

  Nanos now_ = 0;
  LinkWay to_slave_;
  LinkWay to_master_;
  End master_{to_master_, to_slave_, now_};
  End slave_{to_slave_, to_master_, now_};
};

}  // namespace handrail
