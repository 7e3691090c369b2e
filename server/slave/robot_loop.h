// The robot thread's work: one follow_step for every reply of the controller.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "devices/robot.h"
#include "devices/stop_circuit.h"
#include "server/base/clock.h"
#include "server/follow/follow_step.h"
#include "server/record/record_tap.h"
#include "server/slave/mailboxes.h"

namespace handrail {

// Connects, retrying every second; follows the master while the controller answers; comes to a stop
// on the path and ends external control when asked to. A controller that is lost latches a fault
// and is called again only after the operator's reset.
//
//   while (!loop.finished()) { const Nanos next = loop.turn(); if (next > 0) sleep_until(next); }
class RobotLoop {
 public:
  static constexpr Nanos kRetry = kSecond;
  static constexpr Nanos kConnectPatience = 100 * kMillisecond;
  static constexpr Nanos kForceFresh = 20 * kMillisecond;  // older readings count as missing
  static constexpr Nanos kStopPatience = 2 * kSecond;      // for coming to a stop at the end

  // `clock` is read once a turn. Robot, mailboxes, tap and circuit must outlive the loop. `tap`:
  // where each cycle is left for who records; null: nobody does. `stop`: asked once a step, in the
  // loop's thread; null: there is no stop circuit.
  RobotLoop(Robot& robot, const FollowSettings& settings, SlaveMailboxes& boxes,
            Nanos (*clock)() noexcept = monotonic_now, SlaveTap* tap = nullptr,
            StopCircuit* stop = nullptr);

  // Waits for the controller and answers it, or tries to connect. Returns when to come again; 0 =
  // at once. Real-time safe while connected; connecting allocates. Never logs.
  Nanos turn();

  // Asks the loop to stop the arm and finish. From any thread.
  void request_stop() noexcept { stop_requested_.store(true, std::memory_order_relaxed); }
  // True when turn() must not be called again. From any thread.
  bool finished() const noexcept { return finished_.load(std::memory_order_acquire); }
  bool connected() const noexcept { return connected_; }

 private:
  Nanos turn_unconnected();
  void connect();
  // Why there is no controller to drive.
  Reason unconnected() const noexcept;
  void take_reply() noexcept;
  void send() noexcept;
  void step(Nanos now, Reason fault);
  // For who records: what the step remembers, when that is due, and each cycle.
  void keep_image(Nanos now) noexcept;
  void keep_cycle(Nanos now) noexcept;
  void take_news(Nanos now);
  void take_settings();
  // `busy_for`: until the loop speaks again, beyond its usual round.
  void publish(Nanos busy_for = 0);
  void finish_when_standing(Nanos now);
  void finish();

  Robot& robot_;
  FollowSettings settings_;
  SlaveMailboxes& boxes_;
  Nanos (*clock_)() noexcept;
  RobotReply reply_;
  FollowInput input_;
  FollowState state_;
  FollowOutput output_;
  std::optional<JointVector> place_;  // where the next step finds the motion placed
  SlaveTap* tap_;
  StopCircuit* stop_;
  KeptCycle kept_;
  std::uint64_t begins_;  // where the faults' epochs do, until that is kept
  SlaveReport report_;
  MasterNews news_;
  ForceReading force_;
  FollowSettings next_settings_;
  bool settings_wait_ = false;
  bool connected_ = false;
  int refused_ = -1;   // the joint by which an arm that answers cannot be driven
  bool lost_ = false;  // and not yet reset by the operator
  std::uint64_t cycles_ = 0;
  std::uint64_t silences_ = 0;
  Nanos next_attempt_ = -kForever;
  Nanos stepped_at_ = -kForever;
  Nanos stop_since_ = -1;
  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> finished_{false};
};

}  // namespace handrail
