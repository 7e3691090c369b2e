// The master's tick, done again.
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <utility>

#include "proto/config.pb.h"
#include "server/haptic/haptic_run.h"
#include "server/lab/replay/replay_entries.h"
#include "server/master/wall_runs.h"
#include "server/record/device_io.h"
#include "server/record/record_feed.h"

namespace handrail {
namespace {

bool leads(SessionState state) { return state == SessionState::kEngaged; }

// What one of the two, recorded or replayed, was like so far.
class Summing {
 public:
  explicit Summing(ReplaySummary& out) : out_(out) {}
  void add(const pb::RecordedTick& tick) {
    out_.refused += tick.order_result() != 0;
    if (tick.wrench_size() < 3 || tick.command().command_pose_size() < 3) return;
    const Vec3 force(tick.wrench(0), tick.wrench(1), tick.wrench(2));
    sum_ += force.norm();
    out_.most_force = std::max(out_.most_force, force.norm());
    out_.mean_force = sum_ / static_cast<double>(++count_);
    const auto& pose = tick.command().command_pose();
    const Vec3 command(pose[0], pose[1], pose[2]);
    const bool led = leads(static_cast<SessionState>(tick.command().state()));
    if (led) out_.engaged += tick.dt();
    if (led && led_) out_.way += (command - last_).norm();
    if (led) out_.most_off = std::max(out_.most_off, tick.deviation());
    led_ = led;
    last_ = command;
  }
  const Vec3& command() const { return last_; }
  bool led() const { return led_; }

 private:
  ReplaySummary& out_;
  double sum_ = 0.0;
  std::uint64_t count_ = 0;
  bool led_ = false;
  Vec3 last_ = Vec3::Zero();
};

class MasterSide final : public ReplayEntries<pb::RecordedTick, KeptTick> {
 public:
  MasterSide(HapticCapabilities device, pb::MasterConfig config, const RecordedScenes& scenes,
             const ReplayOptions& options, bool exact)
      : device_(std::move(device)),
        config_(std::move(config)),
        scenes_(scenes),
        options_(options),
        compare_(exact) {
    if (options_.link) link_.emplace(*options_.link);
  }

 private:
  Status begin(const pb::RecordedImage& image) override {
    auto scene = loop_scene(image.scene());
    if (!scene) return scene.status();
    run_ = std::make_unique<HapticRun>(*scene);
    if (image.begins() != 0) {
      run_->begin(image.begins());
    } else if (!run_->restore(memory_of(image))) {
      // Of a scene that is asked to be otherwise the memory may be another.
      return Status::error("an image that is not of this build's steps, or of this scene");
    }
    return Status::ok();
  }

  Result<LoopScene> loop_scene(std::uint32_t number) {
    const auto made = made_.find(number);
    if (made != made_.end()) return made->second;
    const Scene* scene = scenes_.find(number);
    if (scene == nullptr) {
      return Status::error("the recording does not have scene " + std::to_string(number) +
                           ", which its ticks name");
    }
    if (Status asked = ask_for_tool(*scene, number); !asked) return asked;
    LoopScene out = loop_scene_of(*scene, device_, config_, kept_runs_.emplace_back());
    out.number = number;
    made_.emplace(number, out);
    return out;
  }

  Status again(ReplayResult& result) override {
    if (run_->scene().number != kept_.scene) {
      auto scene = loop_scene(kept_.scene);
      if (!scene) return scene.status();
      run_->change(*scene);
    }
    if (!options_.as_recorded()) ask_otherwise();
    kept_.given.led_by_cursor = device_.led_by_cursor;
    kept_.came = run_->tick(kept_.given);
    const WallRun* walls = run_->scene().walls;
    const auto* screw =
        walls == nullptr ? nullptr : walls->state.effects.find<ProgressiveFriction>();
    kept_.turned = screw == nullptr ? 0.0 : screw->alpha();
    put(kept_, replayed_);
    was_.add(recorded_);
    is_.add(replayed_);
    result.was = was_sum_;
    result.is = is_sum_;
    if (was_.led() && is_.led()) {
      result.apart = std::max(result.apart, (was_.command() - is_.command()).norm());
    }
    compare_.compare(recorded_, replayed_, recorded_.number(), recorded_.at_ns(), result);
    return Status::ok();
  }

  Status ask_for_tool(const Scene& scene, std::uint32_t number) {
    // A scene of walls has none to take the place of.
    if (options_.tool.empty() || scene.walls) return Status::ok();
    for (const NamedTool& tool : scene.named_tools) {
      if (tool.name != options_.tool) continue;
      asked_tools_[number] = tool.call;
      return Status::ok();
    }
    return Status::error("--tool " + options_.tool + ": scene " + scene.name +
                         " has no tool of that name; 'handrail scene show " + scene.name +
                         "' lists them");
  }

  // Another tool, and a slave that agrees to what is asked: the recorded one had the recorded
  // scene.
  void ask_otherwise() {
    HapticOrder& order = kept_.given.in.order;
    const auto asked = asked_tools_.find(kept_.scene);
    if (order.kind == OrderKind::kTool && asked != asked_tools_.end() &&
        is_position_tool(asked->second.kind) == is_position_tool(order.tool.kind)) {
      order.tool = asked->second;
    }
    if (link_) link_->apply(kept_.at, anew_, kept_.given.in);
    SlaveState& slave = kept_.given.in.slave;
    const MasterState& own = run_->result().out.link;
    slave.scene = run_->scene().haptic.scene;
    slave.hashes = run_->scene().haptic.hashes;
    slave.hashes.tools = own.hashes.tools;
    slave.position_tool_epoch = own.position_tool.epoch;
    slave.orientation_tool_epoch = own.orientation_tool.epoch;
  }

  const HapticCapabilities device_;
  const pb::MasterConfig config_;
  const RecordedScenes& scenes_;
  const ReplayOptions options_;
  ReplayCompare compare_;
  std::optional<AskedLink> link_;  // asked for in place of the recorded one
  std::map<std::uint32_t, LoopScene> made_;
  std::map<std::uint32_t, ToolCall> asked_tools_;  // in place of others, by scene
  std::deque<WallRuns> kept_runs_;
  std::unique_ptr<HapticRun> run_;
  pb::RecordedTick replayed_;
  ReplaySummary was_sum_, is_sum_;
  Summing was_{was_sum_}, is_{is_sum_};
};

}  // namespace

Result<std::unique_ptr<ReplaySide>> replay_master(const pb::RecordedStart& start,
                                                  const RecordedScenes& scenes,
                                                  const ReplayOptions& options) {
  HapticCapabilities device;
  if (Status taken = take(start.device(), device); !taken) return taken;
  pb::MasterConfig config;
  const google::protobuf::LogSilencer silence;  // it would write about it itself
  if (!google::protobuf::TextFormat::ParseFromString(start.configuration(), &config)) {
    return Status::error("the recorded configuration is none of a master of this version");
  }
  std::unique_ptr<ReplaySide> out = std::make_unique<MasterSide>(
      device, config, scenes, options, options.exact && start.build() == record_build());
  return Result<std::unique_ptr<ReplaySide>>(std::move(out));
}

}  // namespace handrail
