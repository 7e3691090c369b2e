// The slave's cycle, done again.
#include <utility>

#include "server/lab/replay/replay_side.h"
#include "server/record/record_feed.h"
#include "server/record/tick_io.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

class SlaveSide final : public ReplaySide {
 public:
  SlaveSide(const pb::RecordedArm& arm, const Payload& payload, const RecordedScenes& scenes,
            bool exact)
      : arm_(arm), payload_(payload), scenes_(scenes), compare_(exact) {}

  Status image(const pb::RecordedImage& image) override {
    if (!running_) waiting_ = image;
    return Status::ok();
  }

  void interrupt() override { running_ = master_known_ = false; }

  Status entry(std::string_view bytes, ReplayResult& result) override {
    if (!recorded_.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
      return Status::error("a message that is no handrail.pb.RecordedCycle");
    }
    ++result.entries;
    if (result.entries == 1) result.begun = recorded_.at_ns();
    // What the file does not have, nothing can go on over.
    if (last_ != 0 && recorded_.number() != last_ + 1) {
      result.missing += recorded_.number() - last_ - 1;
      interrupt();
    }
    last_ = recorded_.number();
    result.seconds = to_seconds(recorded_.at_ns() - result.begun);
    if (Status taken = take(recorded_, kept_); !taken) {
      return Status::error("cycle " + std::to_string(recorded_.number()) + ": " + taken.message());
    }
    if (recorded_.has_master()) {
      *master_.mutable_master() = recorded_.master();
      master_known_ = true;
    } else if (recorded_.master_known() && master_known_) {
      *recorded_.mutable_master() = master_.master();
    }
    if (Status begun = begin(); !begun) return begun;
    return running_ ? again(result) : Status::ok();
  }

 private:
  Status begin() {
    if (running_ || !waiting_ || waiting_->number() != recorded_.number()) return Status::ok();
    const auto image = std::exchange(waiting_, std::nullopt);
    if (recorded_.master_known() && !master_known_) return Status::ok();
    if (image->begins() != 0) {
      state_ = FollowState();
      out_ = FollowOutput();
      state_.fault_epoch = image->begins();
    } else {
      const std::string& bytes = image->part_size() > 0 ? image->part(0) : std::string();
      if (!restore_follow(std::as_bytes(std::span(bytes.data(), bytes.size())), state_, out_)) {
        return Status::error("an image that is not of this build's steps");
      }
    }
    running_ = true;
    return Status::ok();
  }

  Status again(ReplayResult& result) {
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
  bool running_ = false;
  std::optional<pb::RecordedImage> waiting_;
  KeptCycle kept_;
  pb::RecordedCycle recorded_, replayed_, master_;
  bool master_known_ = false;
  std::uint64_t last_ = 0;  // number of the newest
};

}  // namespace

Result<std::unique_ptr<ReplaySide>> replay_slave(const pb::RecordedStart& start,
                                                 const RecordedScenes& scenes,
                                                 const ReplayOptions& options) {
  constexpr int kPayload = 10;
  const pb::RecordedArm& arm = start.arm();
  if (arm.payload_size() != kPayload) {
    return Status::error("arm.payload has " + std::to_string(arm.payload_size()) +
                         " numbers, expected " + std::to_string(kPayload));
  }
  if (arm.period_ns() <= 0) return Status::error("arm.period_ns is no period, expected > 0");
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
