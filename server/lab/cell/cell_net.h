// The cell's link as the daemons have it: two peers and their pumps, joined by a made-up network.
#pragma once

#include <cstdint>
#include <optional>

#include "server/lab/cell/virtual_link.h"
#include "server/link/peer.h"
#include "server/link/pump.h"

namespace handrail {

struct CellNetOptions {
  std::uint64_t seed = 1;  // of the network
  // Of the two programs' clocks before the cell's, >= 0: they need not agree.
  Nanos master_clock = 0;
  Nanos slave_clock = 0;
  std::uint64_t sequence = 0;  // that the datagrams of both programs rise from
};

// All times are the cell's, but for what a peer sees. Real-time safe but for the restarts.
class CellNet {
 public:
  explicit CellNet(const CellNetOptions& options);

  // What arrives by `now` reaches the sockets, and the programs that run take it from them.
  void deliver(Nanos now) noexcept;
  Nanos next_due() const noexcept { return link_.next_due(); }

  // `made`: when the program's loop made the state; one that stood still for long is not sent on.
  void send_master(Nanos now, const MasterState& state, Nanos made) noexcept;
  void send_slave(Nanos now, const SlaveState& state, Nanos made) noexcept;

  // SIGSTOP and SIGCONT: a stopped program takes and sends nothing; its socket fills.
  void stop_master(bool stopped) noexcept { master_stopped_ = stopped; }
  void stop_slave(bool stopped) noexcept { slave_stopped_ = stopped; }
  bool master_stopped() const noexcept { return master_stopped_; }
  bool slave_stopped() const noexcept { return slave_stopped_; }
  // SIGKILL and a new start: another session, an empty socket.
  void restart_master();
  void restart_slave();

  const MasterPeer& master() const noexcept { return *master_; }
  const SlavePeer& slave() const noexcept { return *slave_; }
  VirtualLink& link() noexcept { return link_; }
  // What the clocks of the programs show.
  Nanos master_now(Nanos now) const noexcept { return now + options_.master_clock; }
  Nanos slave_now(Nanos now) const noexcept { return now + options_.slave_clock; }

 private:
  std::uint64_t next_session() noexcept;

  CellNetOptions options_;
  Random random_;
  VirtualLink link_;
  std::optional<MasterPeer> master_;
  std::optional<SlavePeer> slave_;
  std::optional<LinkPump<MasterState, SlaveState>> master_pump_;
  std::optional<LinkPump<SlaveState, MasterState>> slave_pump_;
  bool master_stopped_ = false;
  bool slave_stopped_ = false;
};

}  // namespace handrail
