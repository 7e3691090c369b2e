// A device in a passive hand, both sides' own steps, the link and the simulated arm on one clock.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "devices/hand/min_jerk.h"
#include "server/lab/cell/cell.h"
#include "server/lab/sequences/bounds.h"
#include "server/lab/stability/bare_device.h"
#include "server/lab/stability/contact_meter.h"
#include "server/model/scene.h"

namespace handrail {

// Where counters begin that only a run of months would bring so far.
struct LoopCounters {
  Nanos clock = 0;                     // of the master; the slave's at half of it
  std::uint64_t sequence = 0;          // of the datagrams
  std::optional<std::uint64_t> epoch;  // of stops, faults and engagements
};

struct WholeLoopOptions {
  Scene scene;
  PassiveGrip grip;
  // The plane that the hand moves in, through where it took hold: unit, at right angles, frame M.
  Vec3 along_M = -Vec3::UnitY(), across_M = Vec3::UnitX();
  LinkFaults way;  // each way
  JointVector q_start = ServoArmOptions::default_start();
  std::uint64_t seed = 1;  // of network, arm and sensor
  LoopCounters counters;
};

struct LoopWindow {
  Swing hand;               // in its plane [m]
  Swing tip;                // the true one, along `along_M` and `across_M` in frame S [m]
  double most_given = 0.0;  // of the work on the hand less what the device took, from its start [J]
};

// The hand's device is an Omni as its data say. No force fades for the loop's age, and the motors'
// heat lowers none: both are limits of another kind.
class WholeLoop {
 public:
  explicit WholeLoop(const WholeLoopOptions& options);

  void set(const LinkFaults& way) noexcept;
  // Asks to engage again and again, for so long [s]. False: it did not come to be; why() says.
  bool engage(double patience);
  bool engaged() const noexcept { return engaged_; }
  // The engagement did not last.
  bool ended() const noexcept { return ended_; }
  // After it has ended: as if it had not been engaged before.
  void start_anew() noexcept { engaged_ = ended_ = false; }
  // Of the last refusal, or the end.
  Reason why() const noexcept { return why_; }
  // Empty while it has not ended.
  std::string ended_by() const;

  // The hand means to go by so much in its plane, and to turn, in `seconds` > 0.
  void lead(const Vec2& by, double seconds, const Vec3& turn_M = Vec3::Zero());
  void kick(const Vec2& by) noexcept { device_.kick(by); }
  // Turns the stylus by so much [rad] and back, 5 Hz and gone in half a second: a kick of the
  // wrist.
  void shake(const Vec3& turn_M) noexcept { shake_ = turn_M, shaken_at_ = t_; }
  void tick(const HapticOrder& order = {});
  // False: it ended meanwhile.
  bool pass(double seconds);
  // What happened since the window was begun last.
  void begin_window() noexcept;
  LoopWindow& window() noexcept { return window_; }

  double time() const noexcept { return t_; }  // [s]
  Cell& cell() noexcept { return *cell_; }
  const Cell& cell() const noexcept { return *cell_; }
  const HapticSettings& settings() const noexcept { return settings_; }
  // On the hand, along `along_M` and `across_M` [N].
  const Vec2& force() const noexcept { return force_; }
  // Where the hand asks the tip to be, by the way it has gone since it engaged, frame S [m].
  Vec3 asked() const { return asked_at(device_.position()); }
  // The same by what the device says of the hand.
  Vec3 asked_as_read() const { return asked_at(encoder_.position()); }
  // How far the true tip is from there [m].
  double off() const { return (cell_->rig().true_tip().p - asked()).norm(); }
  const Vec3& start() const noexcept { return tip_0_; }  // of the tip, as it engaged [m]
  // The largest share of what each bound of the master's step allows.
  double bounds() const noexcept { return most_bound_; }
  std::int64_t held() const noexcept { return held_; }  // ticks in a hold
  double share_held() const noexcept { return led_ > 0 ? double(held_) / double(led_) : 0.0; }
  double most_step() const noexcept { return most_step_; }  // of the force between two ticks [N]

 private:
  HandReading reading();
  Vec3 in_M(const Vec2& v) const { return v.x() * options_.along_M + v.y() * options_.across_M; }
  void measure();
  Vec3 asked_at(const Vec2& hand) const;

  WholeLoopOptions options_;
  HapticSettings settings_;
  std::unique_ptr<Cell> cell_;
  BareDevice device_;
  Encoder encoder_;
  Watch bounds_;
  MinJerk way_, turning_;
  double t_ = 0.0, set_out_ = 0.0, shaken_at_ = 0.0;
  Vec3 shake_ = Vec3::Zero();
  Vec2 force_ = Vec2::Zero();
  Vec2 hand_0_ = Vec2::Zero();
  Vec3 tip_0_ = Vec3::Zero();
  bool engaged_ = false, ended_ = false;
  Reason why_ = Reason::kNone, ended_peer_ = Reason::kNone;
  std::int64_t led_ = 0, held_ = 0;
  double most_step_ = 0.0, most_bound_ = 0.0;
  LoopWindow window_;
  double given_0_ = 0.0;  // less lost, as the window began [J]
};

}  // namespace handrail
