// The emulated network without a clock or a device: packets in with their time, packets out with
// theirs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/base/time.h"
#include "server/lab/network/link_way.h"
#include "tests/emulator/edge.h"

namespace handrail::emulator {

enum class Side : std::uint8_t { kNear, kFar };
inline constexpr Side other(Side side) { return side == Side::kNear ? Side::kFar : Side::kNear; }
inline const char* name_of(Side side) { return side == Side::kNear ? "near" : "far"; }

inline constexpr std::size_t kLongestPacket = 1500;  // of Ethernet [bytes]

// Nothing sent in [from, until) arrives.
struct Outage {
  Nanos from = 0, until = 0;
  bool to_far = true, to_near = true;
};

// What a network does. Times are from when it comes into force.
struct NetworkPlan {
  LinkFaults to_far, to_near;
  EdgeSettings edge;
  std::vector<Outage> outages;
  std::vector<Nanos> rebinds, roams;
};

// Of the packets to one side. Those sent, made twice, replayed and injected are those lost,
// overflowed, dark, nobody's and delivered, and those under way.
struct Counts {
  std::uint64_t sent = 0;      // by the other side
  std::uint64_t lost = 0;      // loss and bursts
  std::uint64_t dark = 0;      // in an outage
  std::uint64_t overflow = 0;  // the queue of the rate was full, or too many were under way
  std::uint64_t nobodys = 0;   // the edge did not let them through
  std::uint64_t duplicated = 0;
  std::uint64_t replayed = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t injected = 0;
  std::uint64_t delivered = 0;
  std::uint64_t ignored = 0;  // for neighbours alone, or no packet that is whole; not in `sent`
};

// A packet that has arrived at a side.
struct Arrived {
  Side at = Side::kFar;
  std::size_t size = 0;      // [bytes]
  std::uint64_t number = 0;  // as send() gave it; 0: injected
  Origin origin = Origin::kGenuine;
  Nanos due = 0;
};

// Same seed, same calls: same bytes at the same times. Time never goes backward, and what is due is
// taken before anything is sent.
class Network {
 public:
  explicit Network(std::uint64_t seed);

  // Another plan from `now` on.
  void begin(const NetworkPlan& plan, Nanos now);
  // Other faults and edge from `now` on; the plan's times are added to those still to come.
  void change(const NetworkPlan& plan, Nanos now);

  // A packet that a side sends: its number in its direction, from 1. 0: it goes nowhere.
  std::uint64_t send(Side from, std::span<const std::uint8_t> packet, Nanos now);
  // Somebody else's packet, which arrives as it is, past the edge. At most kLongestPacket.
  void inject(Side to, std::span<const std::uint8_t> packet, Nanos now);
  // When the next packet arrives; kForever if none is under way.
  Nanos next_due() const noexcept;
  // The next packet that has arrived by `now`, written to `out` of kLongestPacket bytes.
  std::optional<Arrived> take(Nanos now, std::span<std::uint8_t> out);

  void roam() noexcept { edge_.roam(); }
  void rebind() noexcept { edge_.rebind(); }

  Counts counts(Side to) const noexcept;

 private:
  struct Way {
    LinkWay link;
    Counts counts;  // what the link does not count
  };
  Way& way_to(Side side) noexcept { return side == Side::kFar ? to_far_ : to_near_; }
  const Way& way_to(Side side) const noexcept { return side == Side::kFar ? to_far_ : to_near_; }
  bool is_dark(Side to, Nanos now) const noexcept;
  // Roams and rebinds that are due by `now`.
  void move_edge(Nanos now);
  std::optional<Arrived> take_from(Side to, Nanos due, std::span<std::uint8_t> out);

  Way to_far_, to_near_;
  Edge edge_;
  std::vector<Outage> outages_;
  std::vector<Nanos> rebinds_, roams_;  // ascending
  Nanos arriving_ = 0;                  // when those waiting at the sides have arrived
  std::vector<std::uint8_t> packet_;
};

}  // namespace handrail::emulator
