// What the haptic loop has said since it was asked last.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "server/master/mailboxes.h"

namespace handrail {

// One who takes it, for all in the IO thread who use it: the mailboxes give everything once.
class LoopNews {
 public:
  // Answers first: the loop publishes before it answers, so that the report is at least as new as
  // every answer here. Never waits.
  void take(MasterMailboxes& boxes) noexcept {
    count_ = 0;
    while (count_ < answers_.size() && boxes.answers.pop(answers_[count_])) ++count_;
    HapticReport report;
    if (boxes.report.take(report)) report_ = report;
  }

  // The newest; nothing before the loop's first tick.
  const std::optional<HapticReport>& report() const noexcept { return report_; }
  // Since the take before.
  std::span<const OrderAnswer> answers() const noexcept { return {answers_.data(), count_}; }

 private:
  std::array<OrderAnswer, 64> answers_{};
  std::size_t count_ = 0;
  std::optional<HapticReport> report_;
};

}  // namespace handrail
