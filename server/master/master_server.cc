#include "server/master/master_server.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/link/link_server.h"
#include "server/link/session_watch.h"
#include "server/master/loop_news.h"

namespace handrail {

struct MasterServer::Impl {
  Impl(MasterMailboxes& mailboxes, OrderDesk& order_desk, MasterServerOptions opts)
      : boxes(mailboxes), desk(order_desk), options(std::move(opts)) {}

  void tick(Nanos now) {
    loop.take(boxes);
    desk.tick(now, loop, link.newest(), link.snapshot());
    if (!loop.report()) return;
    const HapticReport& report = *loop.report();
    if (alive) alive(now, now <= report.good_until);
    const HapticOutput& out = report.out;
    const auto why = [&out](Reason reason) { return reason_text(reason, out.peer_fault); };
    if (const auto line = session.step(now, out.link.state, out.reason, why)) {
      say(out.link.state == SessionState::kFault, *line);
    }
    // Where no robot takes part, a slave is left to another master.
    if (report.walls.present) return link.keep_silent(now);
    link.send(now, report.out.link, report.sent_until, report.good_until);
  }

  static void say(bool bad, const std::string& line) {
    spdlog::log(bad ? spdlog::level::err : spdlog::level::info, line);
  }

  MasterMailboxes& boxes;
  OrderDesk& desk;
  MasterServerOptions options;
  LinkServer<MasterState, SlaveState> link{"haptic", "slave", boxes.doorbell};
  OperatorServer operators{link.io(), desk};
  LoopNews loop;
  SessionWatch session;
  std::function<void(Nanos, bool)> alive;
};

MasterServer::MasterServer(MasterMailboxes& boxes, OrderDesk& desk, MasterServerOptions options)
    : impl_(std::make_unique<Impl>(boxes, desk, std::move(options))) {}
MasterServer::~MasterServer() = default;

Status MasterServer::open() {
  const MasterServerOptions& options = impl_->options;
  const Status opened =
      impl_->link.open({options.address, options.port, options.slave_address, options.slave_port});
  return opened ? impl_->operators.start(options.operator_socket) : opened;
}

std::uint16_t MasterServer::port() const { return impl_->link.port(); }

void MasterServer::run(std::function<void()> on_signal, std::function<bool()> finished,
                       std::function<void(Nanos, bool)> alive) {
  Impl& impl = *impl_;
  impl.alive = std::move(alive);
  const auto end = [on_signal = std::move(on_signal)] {
    spdlog::info("told to end: disengaging");
    on_signal();
  };
  const auto publish = [&impl](Nanos) {
    impl.boxes.slave.publish({impl.link.newest(), impl.link.snapshot()});
  };
  impl.link.run(
      {publish, [&impl](Nanos now) { impl.tick(now); }, end, std::move(finished), &Impl::say});
  impl.operators.stop();
}

}  // namespace handrail
