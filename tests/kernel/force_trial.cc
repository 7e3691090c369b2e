#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <functional>
#include <memory>
#include <string>

#include "devices/force_stick/force_stick.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "tests/kernel/trial.h"
#include "tests/kernel/uinput_device.h"
#include "tests/kernel/uinput_motors.h"

namespace handrail::kernel {
namespace {

constexpr char kStickLink[] = "/tmp/stick";
constexpr int kRight = 0xC000, kUp = 0x8000;  // linux/input.h

// A joystick with room for four effects, and who answers for it.
struct Stick {
  UinputDevice device{
      "Handrail stick", {BTN_TRIGGER, BTN_THUMB, BTN_THUMB2}, {ABS_X, ABS_Y}, kStickLink, 4};
  UinputMotors motors{device.fd()};
};

ForceStickOptions stick_options() {
  ForceStickOptions out;
  out.path = kStickLink;
  out.full = {4.0, 8.0};
  out.upload_period = 2e-3;
  out.most_upload = 10.0;  // an emulated computer is slow
  return out;
}

// A loop that pushes each millisecond, for ten seconds at most.
bool while_pushed(ForceStick& device, const Vec3& force, const std::function<bool()>& until) {
  for (const Nanos end = monotonic_now() + 10 * kSecond; monotonic_now() < end;) {
    (void)device.read(monotonic_now());
    device.write({force, Vec3::Zero()});
    if (until()) return true;
    sleep_until(monotonic_now() + kMillisecond);
  }
  return false;
}

// Nobody pushes any more.
bool comes_to_rest(const std::function<bool()>& what) {
  for (int i = 0; i < 5000 && !what(); ++i) sleep_until(monotonic_now() + kMillisecond);
  return what();
}

std::string levels(Stick& stick) {
  std::string out;
  for (const auto& [id, e] : stick.motors.effects()) {
    out += " effect " + std::to_string(id) + " toward " + std::to_string(e.direction) + " level " +
           std::to_string(e.level) + (e.on ? " on" : " off");
  }
  return out;
}

bool try_levels(Stick& stick, ForceStick& device) {
  // 2 of 4 N right, 2 of 8 N down: half and a quarter of 32767.
  const bool pushed = while_pushed(device, {2.0, -2.0, 0.0}, [&] {
    return stick.motors.pull(kRight) == 16384 && stick.motors.pull(kUp) == -8192;
  });
  bool good = said(pushed, "2 N of 4 right and 2 N of 8 down arrived as" + levels(stick));
  bool lasts = true;
  for (const auto& [id, e] : stick.motors.effects()) {
    lasts = lasts && e.type == FF_CONSTANT && e.lasts == StickPusher::kStickForceLasts;
  }
  good &= said(lasts && stick.motors.gain() == 0xFFFF && stick.motors.centring() == 0,
               "two constant effects of 100 ms, gain full, own centring off");
  const bool rests = comes_to_rest([&] {
    bool none = true;
    for (const auto& [id, e] : stick.motors.effects()) none = none && !e.on && e.level == 0;
    return none;
  });
  return said(rests, "a loop that stood still left" + levels(stick)) && good;
}

bool try_slow(Stick& stick, ForceStick& device) {
  stick.motors.slow(300 * kMillisecond);
  const int before = stick.motors.uploads();
  int turns = 0;
  const bool came = while_pushed(device, {4.0, 0.0, 0.0},
                                 [&] { return ++turns, stick.motors.uploads() >= before + 2; });
  stick.motors.slow(0);
  return said(came && turns > 40, "while two uploads took 300 ms each the loop went on for " +
                                      std::to_string(turns) + " turns");
}

// Another program that pushes and is killed: the kernel takes its effects away.
bool try_killed(Stick& stick) {
  const ::pid_t child = ::fork();
  if (child == 0) {
    ForceStick device(stick_options());
    if (!device.open()) ::_exit(1);
    (void)while_pushed(device, {4.0, 8.0, 0.0}, [] { return false; });
    ::_exit(0);
  }
  const bool pushed = comes_to_rest([&] { return stick.motors.pull(kRight) > 3000; });
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  const bool gone = comes_to_rest([&] { return stick.motors.effects().empty(); });
  return said(pushed && gone, "of a program that was killed as it pushed the kernel left" +
                                  levels(stick) + " (nothing)");
}

bool stick_round(ForceStick& device) {
  Stick stick;
  if (!stick.device.there()) return false;
  if (!while_pushed(device, {4.0, 0.0, 0.0}, [&] { return device.read(monotonic_now()).valid; })) {
    return false;
  }
  stick.device.send(EV_ABS, ABS_X, 16384);
  return while_pushed(device, {4.0, 0.0, 0.0}, [&] {
    const double x = device.read(monotonic_now() + 1).X_MH.p.x();
    return std::abs(x - 0.05) < 1e-4 && stick.motors.pull(kRight) > 1000;
  });
}

bool try_rounds(ForceStick& device, int times) {
  int failed = 0;
  for (int i = 0; i < times; ++i) {
    if (!while_pushed(device, {4.0, 0.0, 0.0},
                      [&] { return !device.read(monotonic_now()).valid; })) {
      ++failed;
    }
    if (!stick_round(device)) ++failed;
  }
  return said(failed == 0, "a stick that pushes, plugged in and unplugged " +
                               std::to_string(times) + " times, " + std::to_string(failed) +
                               " of them otherwise than it should");
}

}  // namespace

bool try_force_stick(int times) {
  ForceStick device(stick_options());
  bool good = true;
  {
    Stick stick;
    const Status opened = device.open();
    if (!said(stick.device.there() && opened.is_ok(),
              "a force-feedback joystick of uinput " + opened.message())) {
      return false;
    }
    good &= try_levels(stick, device);
    good &= try_slow(stick, device);
    device.close();
    good &= said(stick.motors.effects().empty() && stick.motors.erased() == 2,
                 "closing gave back " + std::to_string(stick.motors.erased()) + " of 2 slots");
    good &= try_killed(stick);
    const Status again = device.open();
    good &= said(again.is_ok(), "opened again " + again.message());
  }
  return try_rounds(device, times) && good;
}

}  // namespace handrail::kernel
