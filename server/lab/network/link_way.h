// One way of a network made up from a seed: datagrams go in with their time and come out with it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/base/random.h"
#include "server/base/time.h"
#include "server/lab/network/link_faults.h"

namespace handrail {

// What a way has done so far.
struct WayCounters {
  std::uint64_t sent = 0;      // by the program, so also the number of the last one, from 1
  std::uint64_t lost = 0;      // loss and bursts
  std::uint64_t overflow = 0;  // queues that were full: of the rate, under way, the receiver's
  std::uint64_t duplicated = 0;
  std::uint64_t replayed = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t injected = 0;
  std::uint64_t delivered = 0;  // taken by the receiving program
};

// Where a datagram that arrives is from.
enum class Origin : std::uint8_t { kGenuine, kDuplicate, kReplay, kCorrupt, kInjected };

// A datagram that the receiving program took.
struct Delivery {
  std::uint64_t number = 0;  // rank among the datagrams of the sending side, from 1; 0: injected
  Origin origin = Origin::kGenuine;
  Nanos at = 0;

  // The bytes are those that were sent.
  bool authentic() const noexcept {
    return origin != Origin::kCorrupt && origin != Origin::kInjected;
  }
};

// How much a way holds.
struct WaySize {
  std::size_t longest = 0;         // datagram [bytes]; what is longer is cut
  std::size_t under_way = 4096;    // more are dropped
  std::size_t socket_queue = 256;  // that the receiver has not taken; more are dropped
  std::size_t history = 4096;      // datagrams a replay draws from
  std::size_t headers = 28;        // bytes that the rate counts for each: of IP and UDP
};

// One way. Datagrams under way are ordered by arrival, then by sending. Memory is taken at
// construction; all calls are real-time safe.
class LinkWay {
 public:
  LinkWay(std::uint64_t seed, const WaySize& size);

  LinkFaults faults;

  // Only bytes from `body` on are ever corrupted.
  void send(std::span<const std::uint8_t> bytes, Nanos now, std::size_t body = 0) noexcept;
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
  struct Label {
    std::size_t size = 0;
    std::uint64_t number = 0;
    Origin origin = Origin::kGenuine;
  };
  // So many datagrams of at most `longest` bytes, in one piece of memory.
  class Store {
   public:
    Store(std::size_t count, std::size_t longest);
    std::size_t size() const noexcept { return labels_.size(); }
    void put(std::size_t slot, std::span<const std::uint8_t> bytes, Label label) noexcept;
    std::span<const std::uint8_t> bytes(std::size_t slot) const noexcept;
    const Label& label(std::size_t slot) const noexcept { return labels_[slot]; }

   private:
    std::size_t longest_;
    std::vector<std::uint8_t> bytes_;
    std::vector<Label> labels_;
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
  // False: the rate's queue is full. `start`: when the rate has passed it on.
  bool pass_rate(std::size_t size, Nanos now, Nanos& start) noexcept;
  void launch(std::span<const std::uint8_t> bytes, std::uint64_t number, Origin origin,
              Nanos due) noexcept;
  void launch_corrupted(std::span<const std::uint8_t> bytes, std::size_t body, Nanos due) noexcept;
  void replay(Nanos now) noexcept;
  void damage_copies(std::span<const std::uint8_t> bytes, std::size_t body, Nanos due) noexcept;

  WaySize size_;
  Random random_;         // draws the same number for every datagram sent
  Random replay_random_;  // of their own, so that they do not deal the others anew
  Random bit_random_;
  bool bad_ = false;        // of the burst model
  Nanos last_due_ = 0;      // of those that keep their order
  Nanos rate_free_at_ = 0;  // when the rate has passed on all before
  Store slots_;
  std::vector<std::uint32_t> free_;
  std::vector<Flight> flights_;  // heap, earliest first
  std::vector<std::uint32_t> queue_;
  std::size_t first_ = 0;
  std::size_t queued_ = 0;
  Store history_;
  std::uint64_t remembered_ = 0;
  std::vector<std::uint8_t> damaged_;
  std::uint64_t launched_ = 0;
  std::vector<Delivery> taken_;
  std::size_t taken_count_ = 0;
  WayCounters counters_;
};

}  // namespace handrail
