#include "server/lab/cell/cell_net.h"

#include "server/link/stall_watch.h"

namespace handrail {

CellNet::CellNet(const CellNetOptions& options)
    : options_(options), random_(options.seed), link_(random_.bits()) {
  restart_master();
  restart_slave();
}

std::uint64_t CellNet::next_session() noexcept {
  std::uint64_t session = 0;
  while (session == 0) session = random_.bits();
  return session;
}

void CellNet::restart_master() {
  master_pump_.reset();
  master_.emplace(next_session(), options_.sequence);
  master_pump_.emplace(link_.master(), *master_);
  link_.to_master().flush();
}

void CellNet::restart_slave() {
  slave_pump_.reset();
  slave_.emplace(next_session(), options_.sequence);
  slave_pump_.emplace(link_.slave(), *slave_);
  link_.to_slave().flush();
}

void CellNet::deliver(Nanos now) noexcept {
  link_.at(now);
  if (!master_stopped_) (void)master_pump_->receive(master_now(now));
  if (!slave_stopped_) (void)slave_pump_->receive(slave_now(now));
}

void CellNet::send_master(Nanos now, const MasterState& state, Nanos made) noexcept {
  if (master_stopped_) return;
  link_.at(now);
  master_pump_->send(master_now(now), state, master_now(made) + kHapticStateSent);
}

void CellNet::send_slave(Nanos now, const SlaveState& state, Nanos made) noexcept {
  if (slave_stopped_) return;
  link_.at(now);
  slave_pump_->send(slave_now(now), state, slave_now(made) + kStateStands);
}

}  // namespace handrail
