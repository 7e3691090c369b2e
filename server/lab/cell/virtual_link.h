// A network made up from a seed, in virtual time: two ways, each with its own faults, and what the
// programs at its ends see of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "server/base/time.h"
#include "server/lab/network/link_way.h"
#include "server/link/transport.h"

namespace handrail {

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
