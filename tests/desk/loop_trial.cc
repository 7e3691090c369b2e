#include "tests/desk/loop_trial.h"

#include <algorithm>
#include <memory>
#include <thread>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/base/realtime.h"
#include "server/base/signals.h"
#include "server/lab/figure/quantile.h"
#include "server/master/haptic_loop.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_library.h"
#include "tests/desk/seats.h"

namespace handrail::desk {
namespace {

constexpr int kLoopPriority = 85;  // as the master's haptic thread
constexpr char kLoopScene[] = "linear-movement";
// Till the device is read, the arm engaged and the line called; not measured.
constexpr Nanos kSettling = kSecond;
constexpr double kMostShare = 0.999;

// A slave that follows at once.
class PlayedSlave {
 public:
  PlayedSlave(const LoopScene& scene, MasterMailboxes& boxes) : boxes_(boxes) {
    news_.state.scene = scene.haptic.scene;
    news_.state.hashes = scene.haptic.hashes;
    news_.state.X_ST.p = news_.state.X_ST_command.p = Vec3(0.35, 0.0, 0.42);
    news_.state.has_pose = true;
    news_.link.peer_epoch = 1;
    news_.link.peer_age = 0;
    news_.link.received_of_100 = news_.link.peer_received_of_100 = 100;
  }
  void tell(Nanos now) {
    news_.link.received_at = news_.link.echoed_sent = now;
    boxes_.slave.publish(news_);
  }
  void follow(const MasterState& master) {
    SlaveState& slave = news_.state;
    slave.engagement_epoch = master.engagement_epoch;
    slave.stop_epoch = master.stop_epoch;
    slave.hashes = master.hashes;
    if (master.desired == Desired::kOff) {
      slave.state = SessionState::kOff;
    } else if (master.state == SessionState::kAligning && master.has_command) {
      slave.state = SessionState::kEngaged;
    } else if (master.state == SessionState::kEngaged) {
      slave.X_ST = slave.X_ST_command = master.X_SU;
    }
  }

 private:
  MasterMailboxes& boxes_;
  SlaveNews news_;
};

// The device, its valid readings counted, and with something to be felt each second quarter of a
// second: what makes no force has motors that tremble.
class Watched final : public HapticDevice {
 public:
  explicit Watched(HapticDevice& device) : device_(device) {}
  const HapticCapabilities& capabilities() const override { return device_.capabilities(); }
  Status open() override { return device_.open(); }
  HapticSample read(Nanos now) noexcept override {
    now_ = now;
    HapticSample sample = device_.read(now);
    valid = sample.valid;
    return sample;
  }
  Nanos wait(Nanos due) noexcept override { return device_.wait(due); }
  void write(const Wrench& f_H_M) noexcept override {
    pushes = f_H_M.force.norm() > 0.01;
    device_.write(f_H_M);
  }
  void feel(const HapticCue&) noexcept override {
    const bool felt = now_ / (250 * kMillisecond) % 2 == 1;
    device_.feel(felt ? HapticCue{Felt::kContact, 1.0} : HapticCue{});
  }
  void close() noexcept override { device_.close(); }
  void simulate(const DeviceEffects& effects, const Vec3& home_M) noexcept override {
    device_.simulate(effects, home_M);
  }
  SteerableHand* hand() noexcept override { return device_.hand(); }

  bool valid = false, pushes = false;  // of the last tick

 private:
  HapticDevice& device_;
  Nanos now_ = 0;
};

void order(MasterMailboxes& boxes, std::uint64_t id, OrderKind kind) {
  OrderTicket ticket;
  ticket.id = id;
  ticket.order.kind = kind;
  ticket.order.tool.kind = ToolKind::kLine;
  ticket.order.tool.direction_S = Vec3::UnitX();
  (void)boxes.orders.push(ticket);
}

// Runs it as the master's thread does, and leaves room for nothing else in the measured part.
class LoopRun {
 public:
  LoopRun(Watched& device, const LoopScene& scene)
      : device_(device),
        boxes_(std::make_unique<MasterMailboxes>()),
        slave_(scene, *boxes_),
        loop_(std::make_unique<HapticLoop>(device, scene, *boxes_, monotonic_now())) {}

  LoopRound run(double seconds) {
    round_.late.reserve(static_cast<std::size_t>(seconds * 1e3) + 10);
    round_.work.reserve(round_.late.capacity());
    const SignalsBlocked blocked;
    std::thread thread([this, seconds] { tick_for(seconds); });
    thread.join();
    return std::move(round_);
  }

 private:
  void tick_for(double seconds) {
    (void)enter_realtime(kLoopPriority);
    const Nanos began = monotonic_now();
    const Nanos end = began + kSettling + from_seconds(seconds);
    for (std::uint64_t tick = 0; monotonic_now() < end; ++tick) {
      const Nanos turn = device_.wait(loop_->due());
      const Nanos woke = monotonic_now();
      slave_.tell(woke);
      drive(tick);
      const Nanos from = monotonic_now();
      loop_->tick(woke, turn);
      const Nanos till = monotonic_now();
      (void)boxes_->report.take(report_);
      slave_.follow(report_.out.link);
      OrderAnswer answer;
      while (boxes_->answers.pop(answer)) {
      }
      if (woke - began >= kSettling) keep(woke - turn, till - from);
    }
  }
  // Engages as soon as it may, and calls a line.
  void drive(std::uint64_t tick) {
    if (line_called_ || tick % 100 != 50) return;
    line_called_ = report_.out.link.state == SessionState::kEngaged;
    order(*boxes_, tick, line_called_ ? OrderKind::kTool : OrderKind::kEngage);
  }
  void keep(Nanos late, Nanos work) {
    round_.late.push_back(1e6 * to_seconds(late));
    round_.work.push_back(1e6 * to_seconds(work));
    round_.engaged += report_.out.link.state == SessionState::kEngaged ? 1 : 0;
    round_.valid += device_.valid ? 1 : 0;
    round_.pushed += device_.pushes ? 1 : 0;
  }

  Watched& device_;
  std::unique_ptr<MasterMailboxes> boxes_;
  PlayedSlave slave_;
  std::unique_ptr<HapticLoop> loop_;
  HapticReport report_;
  LoopRound round_;
  bool line_called_ = false;
};

Result<LoopRound> one_round(const SeatRow& row, const Scene& scene, double seconds) {
  auto seat = row.make();
  if (!seat) return seat.status();
  Watched device((*seat)->device());
  WallRuns walls;
  // Nobody is there to hold a dead-man, and the link has no past.
  pb::MasterConfig config;
  config.set_presence(pb::MasterConfig::NONE);
  config.set_good_link_ms(0.0);
  const LoopScene loop_scene = loop_scene_of(scene, device.capabilities(), config, walls);
  if (const Status opened = device.open(); !opened) return opened;
  (*seat)->begin();
  LoopRound out = LoopRun(device, loop_scene).run(seconds);
  (*seat)->end();
  device.close();
  return out;
}

double most_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile_of_sorted(values, kMostShare);
}

LoopSpread spread_of(const LoopSeries& series, std::vector<double> LoopRound::*which) {
  std::vector<double> all;
  for (const LoopRound& round : series.rounds) {
    all.insert(all.end(), (round.*which).begin(), (round.*which).end());
  }
  std::sort(all.begin(), all.end());
  return {quantile_of_sorted(all, 0.5), quantile_of_sorted(all, kMostShare), all.back()};
}

double growth(const LoopSeries& series, const LoopSeries& first,
              std::vector<double> LoopRound::*which) {
  std::vector<double> all;
  for (std::size_t i = 0; i < series.rounds.size() && i < first.rounds.size(); ++i) {
    all.push_back(most_of(series.rounds[i].*which) - most_of(first.rounds[i].*which));
  }
  std::sort(all.begin(), all.end());
  return quantile_of_sorted(all, 0.5);
}

}  // namespace

LoopFigures loop_figures(const LoopSeries& series, const LoopSeries& first) {
  LoopFigures out;
  out.late = spread_of(series, &LoopRound::late);
  out.work = spread_of(series, &LoopRound::work);
  out.late_grows = growth(series, first, &LoopRound::late);
  out.work_grows = growth(series, first, &LoopRound::work);
  double ticks = 0.0;
  for (const LoopRound& round : series.rounds) {
    ticks += static_cast<double>(round.late.size());
    out.valid += static_cast<double>(round.valid);
    out.engaged += static_cast<double>(round.engaged);
    out.pushed += static_cast<double>(round.pushed);
  }
  out.valid /= ticks;
  out.engaged /= ticks;
  out.pushed /= ticks;
  return out;
}

Result<std::vector<LoopSeries>> try_loops(const LoopPlan& plan,
                                          const std::function<bool(const std::string&)>& turn) {
  const auto scene = SceneLibrary().load(kLoopScene);
  if (!scene) return scene.status();
  std::vector<LoopSeries> out;
  std::vector<const SeatRow*> rows;
  for (const SeatRow& row : seat_rows()) {
    const bool wanted =
        plan.devices.empty() || rows.empty() ||
        std::find(plan.devices.begin(), plan.devices.end(), row.name) != plan.devices.end();
    if (!wanted) continue;
    rows.push_back(&row);
    out.push_back({row.name, row.behind, "", {}});
  }
  for (int round = 0; round < plan.rounds; ++round) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!out[i].missing.empty()) continue;
      if (!turn("round " + std::to_string(round + 1) + " of " + std::to_string(plan.rounds) + ": " +
                out[i].device)) {
        return Status::error("stopped");
      }
      auto measured = one_round(*rows[i], *scene, plan.seconds);
      if (measured) {
        out[i].rounds.push_back(std::move(*measured));
      } else {
        out[i].missing = measured.message();
      }
    }
  }
  return out;
}

}  // namespace handrail::desk
