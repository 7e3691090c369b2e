#include "tests/desk/seats.h"

#include <dlfcn.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <string>
#include <thread>
#include <utility>

#include "devices/registry.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/support/comedi/comedi_stand_in.h"
#include "tests/support/fake_force_stick.h"
#include "tests/support/real_spacenavd.h"
#include "tests/support/touch/hd_stand_in.h"

namespace handrail::desk {
namespace {

using MadeSeat = Result<std::unique_ptr<Seat>>;
using MadeDevice = Result<std::unique_ptr<HapticDevice>>;

// As a USB device at full speed tells where it is, every 8 ms.
constexpr Nanos kTold = 8 * kMillisecond;
constexpr std::chrono::milliseconds kSlowUpload(1);  // as a USB control transfer takes

// Goes round in a second, in a thread of its own.
class Mover {
 public:
  // `move`: to a point of the unit circle.
  explicit Mover(std::function<void(double, double)> move)
      : move_(std::move(move)), thread_([this] { run(); }) {}
  ~Mover() {
    stopping_.store(true);
    thread_.join();
  }
  Mover(const Mover&) = delete;
  Mover& operator=(const Mover&) = delete;

 private:
  void run() {
    for (Nanos now = monotonic_now(); !stopping_.load(); now += kTold) {
      const double turn = 2.0 * std::numbers::pi * to_seconds(now % kSecond);
      move_(std::cos(turn), std::sin(turn));
      sleep_until(now + kTold);
    }
  }

  std::function<void(double, double)> move_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last: it uses the others
};

// Whose parts are: a stand-in, the device at it, and who moves it.
template <typename StandIn>
class SeatOf final : public Seat {
 public:
  SeatOf(std::unique_ptr<StandIn> stand_in, std::unique_ptr<HapticDevice> device,
         std::function<void(double, double)> move)
      : stand_in_(std::move(stand_in)), device_(std::move(device)), move_(std::move(move)) {}
  HapticDevice& device() override { return *device_; }
  void begin() override {
    if (move_) mover_ = std::make_unique<Mover>(move_);
  }
  void end() override { mover_.reset(); }

 private:
  std::unique_ptr<StandIn> stand_in_;
  std::unique_ptr<HapticDevice> device_;
  std::function<void(double, double)> move_;
  std::unique_ptr<Mover> mover_;  // last: it uses the others
};

struct Nothing {};

template <typename StandIn>
MadeSeat seat(std::unique_ptr<StandIn> stand_in, const HapticDeviceOptions& options,
              std::function<void(double, double)> move) {
  auto device = make_haptic_device(options);
  if (!device) return device.status();
  return MadeSeat(
      std::make_unique<SeatOf<StandIn>>(std::move(stand_in), std::move(*device), std::move(move)));
}

MadeSeat simulated_seat(HapticDeviceKind kind) {
  HapticDeviceOptions options;
  options.kind = kind;
  options.hand = usual_hand(kind, 1);
  return seat(std::make_unique<Nothing>(), options, nullptr);
}

MadeSeat spacemouse_seat() {
  if (!test::RealSpacenavd::installed()) return Status::error(test::RealSpacenavd::kMissing);
  auto daemon = std::make_unique<test::RealSpacenavd>();
  if (!daemon->start(30 * kSecond)) return Status::error("spacenavd: " + daemon->log());
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kSpaceMouse;
  options.spacemouse.socket = daemon->socket();
  test::Magellan& magellan = daemon->magellan;
  return seat(std::move(daemon), options, [&magellan](double x, double y) {
    (void)magellan.push({static_cast<int>(350.0 * x), 0, static_cast<int>(350.0 * y), 0, 0, 0});
  });
}

MadeSeat gamepad_seat() {
  auto pad = std::make_unique<test::FakeGamepad>();
  pad->make_pad();
  pad->make_motors();
  pad->slow(kSlowUpload);
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kGamepad;
  options.gamepad.path = "/dev/input/made-up";
  options.evdev = pad.get();
  test::FakeGamepad& moved = *pad;
  return seat(std::move(pad), options, [&moved](double x, double y) {
    moved.axis(ABS_X, static_cast<int>(32767.0 * x));
    moved.axis(ABS_Y, static_cast<int>(32767.0 * y));
  });
}

MadeSeat force_stick_seat() {
  auto stick = std::make_unique<test::FakeForceStick>();
  stick->slow(kSlowUpload);
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kForceStick;
  options.force_stick.path = "/dev/input/made-up";
  options.force_stick.full = {4.0, 4.0};
  options.force_stick.most_upload = 10e-3;
  options.force_stick.mass = 0.3;  // as the dissertation's joystick
  options.force_stick.damping = 3.0;
  options.evdev = stick.get();
  test::FakeForceStick& moved = *stick;
  return seat(std::move(stick), options, [&moved](double x, double y) {
    moved.axis(ABS_X, 512 + static_cast<int>(200.0 * x));
    moved.axis(ABS_Y, 512 + static_cast<int>(200.0 * y));
  });
}

// The structure in a library of a stand-in's by which it is told what to do; null: it has none.
template <typename StandIn>
StandIn* stand_in_of(const char* library, const char* name) {
  void* const handle = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);
  void* const found = handle == nullptr ? nullptr : ::dlsym(handle, name);
  StandIn* (*of)() = nullptr;
  static_assert(sizeof of == sizeof found);
  std::memcpy(&of, &found, sizeof of);
  return of == nullptr ? nullptr : of();
}

MadeSeat touch_seat() {
  auto* const hd = stand_in_of<test::HdStandIn>(HANDRAIL_HD_STAND_IN, "hd_stand_in");
  if (hd == nullptr) return Status::error(HANDRAIL_HD_STAND_IN " is no stand-in for libHD");
  hd->reset();
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kTouch;
  options.touch.library = HANDRAIL_HD_STAND_IN;
  return seat(std::make_unique<Nothing>(), options, [hd](double x, double y) {
    const std::lock_guard lock(hd->mutex);
    hd->target = {20.0 * x, 20.0 * y, 0.0};
  });
}

// A card with analog inputs and outputs and counters of 24 bits, as the joystick has.
std::vector<test::StandInSubdevice> joystick_card() {
  test::StandInSubdevice in, out, counter;
  in.type = 1;
  in.values.assign(8, 32768);
  out.type = 2;
  out.values.assign(4, 32768);
  counter.type = 6;
  counter.max_data = 0xffffff;
  counter.values.assign(6, 0);
  return {in, out, counter};
}

MadeSeat joystick_seat() {
  auto* const card = stand_in_of<test::ComediStandIn>(HANDRAIL_COMEDI_STAND_IN, "comedi_stand_in");
  if (card == nullptr) return Status::error(HANDRAIL_COMEDI_STAND_IN " is no stand-in of comedi");
  card->reset();
  card->subdevices = joystick_card();
  HapticDeviceOptions options;
  options.kind = HapticDeviceKind::kJoystick;
  options.joystick.place.library = HANDRAIL_COMEDI_STAND_IN;
  options.joystick.homing = StickHoming::kCentre;
  return seat(std::make_unique<Nothing>(), options, [card](double x, double y) {
    const std::lock_guard lock(card->mutex);
    card->subdevices[2].values[0] = static_cast<unsigned int>(std::lround(200.0 * x)) & 0xffffffu;
    card->subdevices[2].values[1] = static_cast<unsigned int>(std::lround(200.0 * y)) & 0xffffffu;
  });
}

constexpr SeatRow kSeats[] = {
    {"sim-omni", "nothing", [] { return simulated_seat(HapticDeviceKind::kSimOmni); }},
    {"sim-joystick", "nothing", [] { return simulated_seat(HapticDeviceKind::kSimJoystick); }},
    {"spacemouse", "Debian's spacenavd, a Magellan at 125 Hz", spacemouse_seat},
    {"gamepad", "made-up events at 125 Hz, uploads of 1 ms", gamepad_seat},
    {"force-stick", "made-up events at 125 Hz, uploads of 1 ms", force_stick_seat},
    {"touch", "a libHD with the jitter measured at a Touch", touch_seat},
    {"joystick", "a libcomedi, told at 125 Hz", joystick_seat}};

}  // namespace

std::span<const SeatRow> seat_rows() { return kSeats; }

}  // namespace handrail::desk
