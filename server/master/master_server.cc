#include "server/master/master_server.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/link/granted.h"
#include "server/link/link_server.h"
#include "server/link/session_watch.h"
#include "server/master/handle/device_watch.h"
#include "server/master/loop_news.h"

namespace handrail {
namespace {

// Who starts the programs by hand one after the other takes as long.
constexpr Nanos kAlone = 3 * kSecond;
// What counts as no force asked for, so that what a viscous effect makes of tremor does not keep
// the handle's sensor from being taken as zero. A fifth of the friction of a good device [N].
constexpr double kQuietForce = 0.05;

class MasterServer final : public IoServer {
 public:
  MasterServer(MasterMailboxes& mailboxes, OrderDesk& order_desk, MasterServerOptions opts)
      : boxes_(mailboxes), desk_(order_desk), options_(std::move(opts)) {
    desk_.set_link([this](Nanos now) { return link_.identity(now); });
    if (options_.handle != nullptr) handle_.emplace(*options_.handle, options_.handle_watch);
  }
  ~MasterServer() override { desk_.set_link({}); }

  Status open() override {
    link_.keep(options_.packets);
    if (options_.busy_poll) link_.poll_busily();
    if (Status opened = link_.open(options_.link); !opened) return opened;
    if (Status opened = operators_.start(options_.operator_socket); !opened) return opened;
    return options_.remote_operators ? remote_.open(*options_.remote_operators) : Status::ok();
  }

  std::string place() const override {
    const std::string remote = remote_.place();
    return link_.place() + (remote.empty() ? "" : " operators=" + remote);
  }

  void run(ServerHooks hooks) override {
    alive_ = std::move(hooks.alive);
    desk_.set_grants(granted(hooks.control, hooks.io));
    const auto end = [on_signal = std::move(hooks.on_signal)] {
      spdlog::info("told to end: disengaging");
      on_signal();
    };
    const auto publish = [this](Nanos) {
      boxes_.slave.publish({link_.newest(), link_.snapshot()});
    };
    remote_.on_say(say);
    link_.run({publish, [this](Nanos now) { tick(now); }, end, std::move(hooks.finished), say});
    remote_.close();
    operators_.stop();
  }

 private:
  void tick(Nanos now) {
    remote_.tick(now);
    loop_.take(boxes_);
    poll_handle(now);
    desk_.tick(now, loop_, link_.newest(), link_.snapshot());
    if (!loop_.report()) return;
    const HapticReport& report = *loop_.report();
    if (!report.walls.present) say_alone(now);
    if (const auto line = device_.line(now, report.trouble)) {
      say(!text_of(report.trouble).empty(), *line);
    }
    if (alive_) alive_(now, now <= report.good_until);
    const HapticOutput& out = report.out;
    const auto why = [&report](Reason reason) { return reason_text(reason, report); };
    if (const auto line = session_.step(now, out.link.state, out.reason, why)) {
      say(out.link.state == SessionState::kFault, *line);
    }
    // Where no robot takes part, a slave is left to another master.
    if (report.walls.present) return link_.keep_silent(now);
    MasterState told = report.out.link;
    told.record = options_.recorder != nullptr && options_.recorder->asked();
    link_.send(now, told, report.sent_until, report.good_until);
  }

  void poll_handle(Nanos now) {
    if (!handle_) return;
    bool quiet = false;
    if (loop_.report()) {
      const HapticOutput& out = loop_.report()->out;
      quiet = out.link.state == SessionState::kOff && out.f_H_M.force.norm() <= kQuietForce;
    }
    if (handle_->step(now, quiet)) boxes_.handle.publish(handle_->reading());
    if (const auto line = handle_->line(now)) say(line->bad, line->text);
  }

  // Once, where nothing else says why.
  void say_alone(Nanos now) {
    if (alone_since_ == kForever) alone_since_ = now;
    if (said_alone_ || now - alone_since_ < kAlone) return;
    said_alone_ = true;
    if (link_.snapshot().peer_epoch != 0 || link_.snapshot().other_version(now) != 0) return;
    if (!link_.identity(now).encrypted) {
      say(true, "no slave has answered at " + options_.slave_at + ": start handrail-slave there");
    }
  }

  static void say(bool bad, const std::string& line) {
    spdlog::log(bad ? spdlog::level::err : spdlog::level::info, line);
  }

  MasterMailboxes& boxes_;
  OrderDesk& desk_;
  MasterServerOptions options_;
  LinkServer<MasterState, SlaveState> link_{"haptic", "slave", boxes_.doorbell};
  OperatorServer operators_{link_.io(), desk_};
  RemoteOperatorServer remote_{link_.io(), operators_};
  LoopNews loop_;
  std::optional<HandleWatch> handle_;
  SessionWatch session_;
  DeviceWatch device_;
  Nanos alone_since_ = kForever;
  bool said_alone_ = false;
  std::function<void(Nanos, bool)> alive_;
};

}  // namespace

std::unique_ptr<IoServer> make_master_server(MasterMailboxes& boxes, OrderDesk& desk,
                                             MasterServerOptions options) {
  return std::make_unique<MasterServer>(boxes, desk, std::move(options));
}

}  // namespace handrail
