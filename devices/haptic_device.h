// The narrow interface under the haptic loop.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/base/fixed_text.h"
#include "server/base/pacer.h"
#include "server/base/spatial.h"
#include "server/base/status.h"
#include "server/base/time.h"
#include "server/model/device_dynamics.h"
#include "server/model/effect_list.h"
#include "server/model/haptic_cue.h"

namespace handrail {

// How long a force acts that is not written anew: a loop that stands still must not leave it on the
// hand.
inline constexpr Nanos kForceStands = 50 * kMillisecond;

// What is wrong with a device, and what to do, for a person; empty: nothing that is known.
using DeviceTrouble = FixedText<200>;

// What a device can do, as data. All values > 0 unless said otherwise; SI.
struct HapticCapabilities {
  std::string name;
  bool simulated = false;
  bool senses_rotation = false;
  bool actuates_torque = false;
  double max_force = 0.0;         // peak; 0: it makes none, and `dynamics` says nothing [N]
  double continuous_force = 0.0;  // sustainable [N]
  double max_torque = 0.0;        // peak [N m]; 0 without torque
  DeviceDynamics dynamics;        // what stability is reckoned with
  DeviceDynamics turning;         // the same of a device with torque, of turning the stylus
  Vec3 workspace_half =
      Vec3::Zero();  // half extents of the nominal work space about M's origin [m]
  int buttons = 0;
  double velocity_lag = 0.0;   // mean delay of the velocity it reports, >= 0 [s]
  bool led_by_cursor = false;  // lead() moves its hand
  double least_mass = 0.05;    // that moves, of device and a light hand together [kg]
};

// One reading. Frame M.
struct HapticSample {
  Pose X_MH;                  // stylus tip
  Vec3 v_MH = Vec3::Zero();   // velocity of the tip [m/s]
  std::uint32_t buttons = 0;  // bits 0 to 2 = buttons 1 (clutch), 2 (drop the tool), 3 (enable)
  bool valid = false;         // false: nothing else in the sample may be used
  // A force that was written since the last reading came too late for its turn: the one before it
  // acted a turn longer.
  bool force_missed = false;
};

// Where a simulated hand should go: a minimum-jerk move from where its intent stands now. Limits:
// hand_move.h.
struct HandIntent {
  bool home = false;                   // to where the hand begins, whatever the next two say
  Vec3 displacement_M = Vec3::Zero();  // [m]
  Vec3 rotation_M = Vec3::Zero();      // rotation vector, frame M [rad]
  double duration = 1.0;               // > 0 [s]
  std::uint32_t buttons = 0;           // buttons held during the move
};

// A cursor counts as long as this after it came; then who led it is taken to have gone.
inline constexpr Nanos kCursorPatience = 200 * kMillisecond;

// Where a page's cursor sends the hand. Frame M.
struct CursorSample {
  std::uint64_t sequence = 0;
  Pose X_MC;                  // finite
  std::uint32_t buttons = 0;  // as in HapticSample; the third is the dead-man
  Nanos at = -kForever;       // when it came, by the clock of read()
};

// The hand behind a simulated device, for those who have no hardware.
class SteerableHand {
 public:
  virtual ~SteerableHand() = default;
  // Starts a move; replaces a running one from where it stands. Real-time safe.
  virtual void steer(const HandIntent& intent) noexcept = 0;
  // True while a move runs. Real-time safe.
  virtual bool moving() const noexcept = 0;
};

// A haptic device. Every method is called from the haptic thread only; `read` and `write` are
// real-time safe and alternate once a tick.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  virtual const HapticCapabilities& capabilities() const = 0;
  // Makes the device ready, force off. May block and allocate. The error names device and cause.
  virtual Status open() = 0;
  // The newest reading at time `now`, which never goes backward. A simulated device advances its
  // model to `now` under the wrench last written.
  virtual HapticSample read(Nanos now) noexcept = 0;
  // Why the last reading was not valid. Real-time safe.
  virtual DeviceTrouble trouble() const noexcept { return {}; }
  // Before read(): waits for the loop's next turn, which its own clock has at `due`, and returns
  // when that turn was due by monotonic_now(). A device that turns by itself calls the loop as soon
  // as it has a new reading, so that the force for it is written in the device's own turn, and
  // returns the time of that reading. One that does not turn when it is expected to is waited for
  // by kTurnPatience, and when that turn was expected is returned; while it is silent after that,
  // `due`: the loop goes on by its own clock. Real-time safe but that it waits.
  virtual Nanos wait(Nanos due) noexcept {
    sleep_until(due);
    return due;
  }
  // Applies f_H_M, force and torque of the device on the hand, frame M, until the next call, but no
  // longer than kForceStands: then the device lets go by itself, whatever became of the thread that
  // calls. A driver does so in the device, or in a thread of its own. The caller has limited f_H_M
  // to the capabilities already.
  virtual void write(const Wrench& f_H_M) noexcept = 0;
  // After write(): what is to be felt beside force from now until the next call, but no longer than
  // kForceStands. For devices that make no force; those that do have the same in write(). A device
  // may ignore it. Real-time safe.
  virtual void feel(const HapticCue&) noexcept {}
  // Force off, device released. Safe to call twice.
  virtual void close() noexcept = 0;
  // A simulated device shows these of its own effects from now on, and its hand begins at `home_M`
  // [m]: before the first reading it is there, after it goes there within a second. Others have
  // what they have. Real-time safe.
  virtual void simulate(const DeviceEffects&, const Vec3& home_M) noexcept { (void)home_M; }
  // Only of a device that is led by a cursor: its hand goes there. Real-time safe.
  virtual void lead(const CursorSample&) noexcept {}
  // The simulated hand that holds the device, or null on real hardware and on recordings.
  virtual SteerableHand* hand() noexcept { return nullptr; }
  // Force of the simulated hand on the handle, as a sensor between them would feel it, mean of the
  // time between the last two readings, frame M [N]. None: no simulated hand holds it. Simulated;
  // real-time safe.
  virtual std::optional<Vec3> simulated_push() const noexcept { return std::nullopt; }
};

}  // namespace handrail
