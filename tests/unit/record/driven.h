// A master's step and a slave's, driven by random hands and orders, that leave all in their taps.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "devices/omni/sim_omni.h"
#include "server/base/random.h"
#include "server/lab/replay/replay.h"
#include "server/master/wall_runs.h"
#include "server/record/device_io.h"
#include "server/record/record_setup.h"
#include "server/record/recorder.h"
#include "server/record/scene_records.h"
#include "server/slave/follow_settings.h"

namespace handrail::test {

// One master; scenes by name, as the daemon loads them.
class DrivenMaster {
 public:
  explicit DrivenMaster(std::uint64_t seed, const std::string& scene = "linear-movement")
      : device_(SimOmni(HandOptions(), false).capabilities()), random_(seed) {
    config_.set_good_link_ms(0);
    load(scene);
    run_ = std::make_unique<HapticRun>(made_);
    run_->begin(begins_);
  }

  MasterTap& tap() { return *tap_; }
  pb::RecordedStart start() const {
    pb::RecordedStart out = recorded_start("handrail-master", 7, config_);
    put(device_, *out.mutable_device());
    return out;
  }
  const std::vector<pb::RecordedScene>& scenes() const { return scenes_; }

  // Loads another scene, which the next tick takes over.
  pb::RecordedScene change(const std::string& scene) {
    load(scene);
    run_->change(made_);
    return scenes_.back();
  }

  void order(OrderKind kind) { next_.kind = kind; }

  // `image`: one stands in the tap before it, whatever the time.
  void tick(bool image = false) {
    now_ += kMillisecond;
    ++kept_.number;
    if (image || begins_ != 0 || tap_->image_due(now_)) {
      MasterTap::Image& to = tap_->image();
      to.number = kept_.number;
      to.scene = run_->scene().number;
      to.begins = std::exchange(begins_, 0);
      to.size = run_->save(to.bytes);
      tap_->keep_image(now_);
    }
    HapticTick& given = kept_.given;
    given.dt = 1e-3 * (0.5 + random_.uniform());
    given.let_go = random_.bits() % 500 == 0;
    HapticInput& in = given.in;
    hand_ += 4e-4 * Vec3(random_.normal(), random_.normal(), random_.normal());
    in.hand.X_MH.p = hand_;
    in.hand.v_MH = 0.1 * Vec3(random_.normal(), random_.normal(), random_.normal());
    in.hand.valid = random_.bits() % 50 != 0;
    in.order = HapticOrder();
    if (random_.bits() % 200 == 0) in.order.kind = static_cast<OrderKind>(random_.bits() % 12);
    // Stops and faults would end every recording: those are asked for.
    if (in.order.kind == OrderKind::kStop) in.order.kind = OrderKind::kReset;
    if (in.order.kind == OrderKind::kTool) in.order.tool.kind = ToolKind::kPoint;
    if (in.order.kind == OrderKind::kStage) in.order.stage = static_cast<int>(random_.bits() % 3);
    const MasterState& led = run_->result().out.link;
    const bool off = led.state == SessionState::kOff || led.state == SessionState::kFault;
    if (kept_.number % 50 == 0 && off) {
      in.order.kind = led.state == SessionState::kOff ? OrderKind::kEngage : OrderKind::kReset;
    }
    if (next_.kind != OrderKind::kNone) in.order = std::exchange(next_, HapticOrder());
    // A slave that agrees, and whose tip comes after.
    in.slave_known = kept_.number > 10;
    in.slave.hashes = run_->scene().haptic.hashes;
    in.slave.hashes.tools = led.hashes.tools;
    in.slave.scene = run_->scene().haptic.scene;
    in.slave.has_pose = true;
    in.slave.state = led.desired == Desired::kOff ? SessionState::kOff : SessionState::kEngaged;
    in.slave.engagement_epoch = led.engagement_epoch;
    in.slave.stop_epoch = led.stop_epoch;
    if (led.has_command) tip_ += 0.02 * (led.X_SU.p - tip_);
    in.slave.X_ST.p = in.slave.X_ST_command.p = tip_;
    in.slave.cycles = kept_.number / 7;
    in.slave_age = 2 * kMillisecond;
    kept_.at = now_;
    kept_.scene = run_->scene().number;
    kept_.came = run_->tick(given);
    const WallRun* walls = run_->scene().walls;
    const auto* screw =
        walls == nullptr ? nullptr : walls->state.effects.find<ProgressiveFriction>();
    kept_.turned = screw == nullptr ? 0.0 : screw->alpha();
    tap_->keep(kept_);
  }

 private:
  void load(const std::string& name) {
    scene_ = std::make_unique<Scene>(*records_.load(SceneLibrary(), name));
    made_ = loop_scene_of(*scene_, device_, config_, runs_);
    made_.number = static_cast<std::uint32_t>(scenes_.size() + 1);
    scenes_.push_back(records_.take(scene_->name, made_.number));
  }

  const HapticCapabilities device_;
  pb::MasterConfig config_;
  Random random_;
  SceneRecords records_{true};
  WallRuns runs_;
  std::unique_ptr<Scene> scene_;
  LoopScene made_;
  std::vector<pb::RecordedScene> scenes_;
  std::unique_ptr<HapticRun> run_;
  std::unique_ptr<MasterTap> tap_ = std::make_unique<MasterTap>();
  KeptTick kept_;
  HapticOrder next_;
  Vec3 hand_ = Vec3::Zero();
  Vec3 tip_ = Vec3(0.35, 0.0, 0.42);
  Nanos now_ = kSecond;
  std::uint64_t begins_ = 4711;
};

inline RecorderOptions to_folder(const std::string& folder) {
  RecorderOptions out;
  out.folder = folder;
  return out;
}

// Until `done`, for at most five seconds; whether it came.
template <typename F>
bool wait_until(F done) {
  for (int i = 0; i < 500 && !done(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return done();
}

inline Result<ReplayResult> replay_file(const std::string& path,
                                        const ReplayOptions& options = {}) {
  std::ifstream in(path, std::ios::binary);
  return replay(in, options);
}

}  // namespace handrail::test
