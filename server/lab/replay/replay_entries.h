// What both sides of a replay do with ticks and cycles, one after another.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "server/lab/replay/replay_side.h"
#include "server/record/tick_io.h"

namespace handrail {

// The other side's state in a message, by one name.
inline const pb::SlaveDatagram* other_in(const pb::RecordedTick& tick) {
  return tick.has_slave() ? &tick.slave() : nullptr;
}
inline pb::SlaveDatagram* put_other(pb::RecordedTick& tick) { return tick.mutable_slave(); }
inline bool knows_other(const pb::RecordedTick& tick) { return tick.slave_known(); }
inline const pb::MasterDatagram* other_in(const pb::RecordedCycle& cycle) {
  return cycle.has_master() ? &cycle.master() : nullptr;
}
inline pb::MasterDatagram* put_other(pb::RecordedCycle& cycle) { return cycle.mutable_master(); }
inline bool knows_other(const pb::RecordedCycle& cycle) { return cycle.master_known(); }

// Finds where the step can begin, and does each entry again from there on.
template <typename Message, typename Kept>
class ReplayEntries : public ReplaySide {
 public:
  Status image(const pb::RecordedImage& image) override {
    waiting_ = image;  // for its tick, which may be the first after some that are missing
    return Status::ok();
  }

  void interrupt() override {
    runs_ = false;
    other_.reset();
  }

  Status entry(std::string_view bytes, ReplayResult& result) override {
    if (!recorded_.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
      return Status::error("a message that is no " + Message::descriptor()->full_name());
    }
    if (++result.entries == 1) result.begun = recorded_.at_ns();
    // What the file does not have, nothing can go on over.
    if (last_ != 0 && recorded_.number() != last_ + 1) {
      result.missing += recorded_.number() - last_ - 1;
      interrupt();
    }
    last_ = recorded_.number();
    result.seconds = to_seconds(recorded_.at_ns() - result.begun);
    if (Status taken = take(recorded_, kept_); !taken) {
      return Status::error("number " + std::to_string(last_) + ": " + taken.message());
    }
    // Most leave it out: it is that of the one before.
    anew_ = other_in(recorded_) != nullptr;
    if (const auto* other = other_in(recorded_)) {
      other_ = *other;
    } else if (knows_other(recorded_) && other_) {
      *put_other(recorded_) = *other_;
    }
    if (waiting_ && waiting_->number() == recorded_.number()) {
      const auto image = std::exchange(waiting_, std::nullopt);
      // A step that is on its way needs none. After an interruption the other side's state may be
      // missing until it changes.
      // A program that began anew remembers nothing.
      if (image->begins() != 0 || (!runs_ && (!knows_other(recorded_) || other_))) {
        if (Status begun = begin(*image); !begun) return begun;
        runs_ = true;
      }
    }
    return runs_ ? again(result) : Status::ok();
  }

 protected:
  // Puts the step to where the image has it.
  virtual Status begin(const pb::RecordedImage& image) = 0;
  // The step with `kept_`, beside what is in `recorded_`.
  virtual Status again(ReplayResult& result) = 0;

  static std::span<const std::byte> memory_of(const pb::RecordedImage& image) {
    if (image.part_size() == 0) return {};
    return std::as_bytes(std::span(image.part(0).data(), image.part(0).size()));
  }

  Message recorded_;
  Kept kept_;
  bool anew_ = false;  // the entry brought a state of the other side that was not there before

 private:
  using Other = std::remove_cvref_t<decltype(*other_in(std::declval<const Message&>()))>;
  std::optional<Other> other_;
  std::optional<pb::RecordedImage> waiting_;
  bool runs_ = false;
  std::uint64_t last_ = 0;  // number of the newest
};

}  // namespace handrail
