// The slave's cycle, done again.
#include <utility>

#include "server/lab/replay/replay_entries.h"
#include "server/record/record_feed.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

class SlaveSide final : public ReplayEntries<pb::RecordedCycle, KeptCycle> {
 public:
  SlaveSide(const pb::RecordedArm& arm, const Payload& payload, const RecordedScenes& scenes,
            bool exact)
      : arm_(arm), payload_(payload), scenes_(scenes), compare_(exact) {}

 private:
  Status begin(const pb::RecordedImage& image) override {
    if (image.begins() != 0) {
      state_ = FollowState();
      out_ = FollowOutput();
      state_.fault_epoch = image.begins();
    } else if (!restore_follow(memory_of(image), state_, out_)) {
      return Status::error("an image that is not of this build's steps");
    }
    return Status::ok();
  }

  Status again(ReplayResult& result) override {
    if (number_ != kept_.scene) {
      const Scene* scene = scenes_.find(kept_.scene);
      if (scene == nullptr) {
        return Status::error("the recording does not have scene " + std::to_string(kept_.scene) +
                             ", which its cycles name");
      }
      settings_ = follow_settings(*scene, arm_.period_ns(), arm_.has_sensor(), arm_.sensor_range(),
                                  payload_, arm_.force_lag());
      number_ = kept_.scene;
    }
    if (kept_.placed) place(settings_, kept_.place, state_);
    follow_step(settings_, kept_.given, state_, out_);
    kept_.came = out_;
    put(kept_, replayed_);
    // What the robot's loop counts is no output of the step.
    replayed_.mutable_state()->set_cycles(recorded_.state().cycles());
    replayed_.mutable_state()->set_silences(recorded_.state().silences());
    compare_.compare(recorded_, replayed_, recorded_.number(), recorded_.at_ns(), result);
    return Status::ok();
  }

  const pb::RecordedArm arm_;
  const Payload payload_;
  const RecordedScenes& scenes_;
  ReplayCompare compare_;
  FollowSettings settings_;
  std::uint32_t number_ = 0;  // whose settings they are; 0: none's
  FollowState state_;
  FollowOutput out_;
  pb::RecordedCycle replayed_;
};

}  // namespace

Result<std::unique_ptr<ReplaySide>> replay_slave(const pb::RecordedStart& start,
                                                 const RecordedScenes& scenes,
                                                 const ReplayOptions& options) {
  constexpr int kPayload = 10;  // mass, centre, bias of force and of torque
  const pb::RecordedArm& arm = start.arm();
  if (arm.payload_size() != kPayload) {
    return Status::error("arm.payload has " + std::to_string(arm.payload_size()) +
                         " numbers, expected " + std::to_string(kPayload));
  }
  if (arm.period_ns() < kMillisecond || arm.period_ns() > kSecond) {
    return Status::error("arm.period_ns is " + std::to_string(arm.period_ns()) +
                         ", expected 1 ms to 1 s");
  }
  if (options.link) {
    return Status::error(
        "--link is for a master's recording: what a slave hears later it does later");
  }
  if (!options.tool.empty()) {
    return Status::error("--tool is for a master's recording: a slave takes the tools it is told");
  }
  Payload payload;
  payload.mass = arm.payload(0);
  for (int i = 0; i < 3; ++i) {
    payload.centre_T[i] = arm.payload(1 + i);
    payload.bias_T.force[i] = arm.payload(4 + i);
    payload.bias_T.torque[i] = arm.payload(7 + i);
  }
  std::unique_ptr<ReplaySide> out = std::make_unique<SlaveSide>(
      arm, payload, scenes, options.exact && start.build() == record_build());
  return Result<std::unique_ptr<ReplaySide>>(std::move(out));
}

}  // namespace handrail
