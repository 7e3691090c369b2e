#include "tests/support/touch/hd_stand_in.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

namespace {

using handrail::test::HdStandIn;

HdStandIn& self() {
  static HdStandIn state;
  return state;
}
using Lock = std::lock_guard<std::mutex>;

using Callback = std::uint32_t (*)(void*);
struct Scheduler {
  std::thread thread;
  std::atomic<bool> stops{false};
  Callback callback = nullptr;
  void* data = nullptr;
};
Scheduler& scheduler() {
  static Scheduler state;
  return state;
}

constexpr std::uint32_t kHandle = 7;
thread_local bool in_frame = false;
thread_local bool is_current = false;

void misuse(const char* what) { self().misuses.emplace_back(what); }
// With the mutex held.
void need_frame(const char* what) {
  if (!in_frame) misuse(what);
}
void need_current(const char* what) {
  if (!is_current) misuse(what);
}

// A hand of 0.1 kg, 250 N/m and 7 N s/m around the stylus, a millisecond on.
void move_hand(HdStandIn& s) {
  constexpr double kStep = 1e-3;
  for (std::size_t i = 0; i < 3; ++i) {
    const double force = s.output ? s.force[i] : 0.0;
    const double pull = 250.0 * (s.target[i] - s.place[i]) * 1e-3 - 7.0 * s.speed[i] * 1e-3;
    s.speed[i] += (force + pull) / 0.1 * kStep * 1e3;
    s.place[i] += s.speed[i] * kStep;
  }
}

// A thousand turns a second, as measured at a Touch on USB (977 to 1013): about 0.03 ms of jitter,
// now and then more than a millisecond, and never sooner after the last than at 1237 Hz.
void turn() {
  int tick = 0;
  auto due = std::chrono::steady_clock::now();
  while (!scheduler().stops.load()) {
    const auto turned = std::chrono::steady_clock::now();
    int pause = 1000, stalls = 0;
    bool turns = true;
    {
      const Lock lock(self().mutex);
      pause = self().pause_us;
      turns = self().turns;
      stalls = self().stalls;
      ++self().ticks;
    }
    is_current = false;
    if (turns && scheduler().callback != nullptr) scheduler().callback(scheduler().data);
    int late = ++tick % 500 == 0 ? 1400 : tick % 2 == 0 ? 30 : -30;
    if (stalls != 0 && tick % stalls == 0) late += 20'000;
    due += std::chrono::microseconds(pause + late);
    due = std::max(due, turned + std::chrono::microseconds(pause * 1000 / 1237));
    std::this_thread::sleep_until(due);
  }
}

struct ErrorInfo {
  std::uint32_t code;
  int internal;
  std::uint32_t device;
};

}  // namespace

extern "C" {

HdStandIn* hd_stand_in() { return &self(); }

std::uint32_t hdInitDevice(const char* name) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  ++s.opened;
  if (s.init_error != 0 || (name != nullptr && s.name != name) || s.open_devices > 0) {
    s.errors.push_back(s.init_error != 0 ? s.init_error : s.open_devices > 0 ? 0x301 : 0x303);
    return 0xffffffff;
  }
  ++s.open_devices;
  is_current = true;
  return kHandle;
}

void hdDisableDevice(std::uint32_t device) {
  const Lock lock(self().mutex);
  if (device != kHandle) misuse("hdDisableDevice of another device");
  if (scheduler().thread.joinable()) misuse("hdDisableDevice while the scheduler runs");
  --self().open_devices;
}

void hdMakeCurrentDevice(std::uint32_t device) {
  const Lock lock(self().mutex);
  if (device != kHandle) misuse("hdMakeCurrentDevice of another device");
  is_current = true;
}

void hdBeginFrame(std::uint32_t) {
  const Lock lock(self().mutex);
  if (in_frame) misuse("hdBeginFrame in a frame");
  in_frame = true;
}

void hdEndFrame(std::uint32_t) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  if (!in_frame) misuse("hdEndFrame outside a frame");
  in_frame = false;
  const auto answers = [&s](double place) { return std::abs(s.force[0] - 0.1 * place) < 1e-9; };
  ++(answers(s.told_place) ? s.answered : answers(s.place_before) ? s.answered_late : s.unanswered);
  s.place_before = s.told_place;
  move_hand(s);
  if (s.tick_error == 0) return;
  s.errors.push_back(s.tick_error);
  // Errors of force and device switch the motors off.
  if (s.tick_error >= 0x200) s.output = false;
}

ErrorInfo hdGetError() {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  if (s.errors.empty()) return {0, 0, kHandle};
  const std::uint32_t code = s.errors.back();
  s.errors.pop_back();
  return {code, static_cast<int>(code) + 1, kHandle};
}

const char* hdGetErrorString(std::uint32_t code) {
  return code == 0x600 ? "Invalid license" : code == 0x302 ? "Communication error" : "Some error";
}

void hdEnable(std::uint32_t what) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  need_current("hdEnable without a device");
  if (what != 0x4000) return;
  if (s.calibration != 0x5000) misuse("force switched on before calibration");
  s.output = true;
  ++s.enabled;
}

void hdDisable(std::uint32_t what) {
  const Lock lock(self().mutex);
  need_current("hdDisable without a device");
  if (what == 0x4000) self().output = false;
}

void hdGetIntegerv(std::uint32_t what, std::int32_t* out) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  need_current("hdGetIntegerv without a device");
  if (what == 0x2000) {
    need_frame("buttons outside a frame");
    *out = s.buttons;
  } else if (what == 0x2555) {
    *out = s.styles;
  } else {
    s.errors.push_back(0x100);
  }
}

void hdGetDoublev(std::uint32_t what, double* out) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  need_current("hdGetDoublev without a device");
  const auto [w, x, y, z] = s.turn;
  switch (what) {
    case 0x2052: {  // column by column
      need_frame("transform outside a frame");
      const double wild = s.not_a_pose ? std::nan("") : 0.0;
      std::array<double, 3> p = s.frozen ? std::array<double, 3>{} : s.place;
      for (std::size_t i = 0; i < 3; ++i) p[i] += s.off[i];
      const double m[16] = {1 - 2 * (y * y + z * z),
                            2 * (x * y + w * z),
                            2 * (x * z - w * y),
                            0,
                            2 * (x * y - w * z),
                            1 - 2 * (x * x + z * z),
                            2 * (y * z + w * x),
                            0,
                            2 * (x * z + w * y),
                            2 * (y * z - w * x),
                            1 - 2 * (x * x + y * y),
                            0,
                            p[0] + wild,
                            p[1],
                            p[2],
                            1};
      std::memcpy(out, m, sizeof m);
      s.told_place = m[12];
      return;
    }
    case 0x2051:
      need_frame("velocity outside a frame");
      for (std::size_t i = 0; i < 3; ++i) out[i] = s.frozen ? 0.0 : s.speed[i];
      return;
    case 0x2603: *out = s.nominal_force; return;
    case 0x2605:
      for (int i = 0; i < 3; ++i) out[i] = i == 1 ? s.temperature : 0.1;
      return;
    default: s.errors.push_back(0x100);
  }
}

const char* hdGetString(std::uint32_t what) {
  return what == 0x2501   ? "PHANTOM Omni"
         : what == 0x2504 ? "1234"
         : what == 0x2502 ? "4.2.122"
                          : nullptr;
}

void hdSetDoublev(std::uint32_t what, const double* in) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  need_current("hdSetDoublev without a device");
  need_frame("force outside a frame");
  if (what != 0x2700) {
    s.errors.push_back(0x100);
    return;
  }
  double size = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    s.force[i] = in[i];
    size += in[i] * in[i];
  }
  s.most_force = std::max(s.most_force, std::sqrt(size));
}

std::uint32_t hdCheckCalibration() {
  const Lock lock(self().mutex);
  need_current("hdCheckCalibration without a device");
  return self().calibration;
}

void hdUpdateCalibration(std::uint32_t style) {
  HdStandIn& s = self();
  const Lock lock(s.mutex);
  if (s.calibration != 0x5001) misuse("hdUpdateCalibration though none is due");
  ++s.updates;
  s.style = style;
  if (s.update_homes) s.calibration = 0x5000;
}

void hdStartScheduler() {
  HdStandIn& s = self();
  {
    const Lock lock(s.mutex);
    if (s.start_error != 0) {
      s.errors.push_back(s.start_error);
      return;
    }
  }
  scheduler().stops = false;
  scheduler().thread = std::thread(turn);
}

void hdStopScheduler() {
  scheduler().stops = true;
  if (scheduler().thread.joinable()) scheduler().thread.join();
}

void hdSetSchedulerRate(unsigned long rate) {
  const Lock lock(self().mutex);
  self().rate = rate;
}

unsigned long hdScheduleAsynchronous(Callback callback, void* data, std::uint16_t priority) {
  const Lock lock(self().mutex);
  scheduler().callback = callback;
  scheduler().data = data;
  self().priority = priority;
  return 3;
}

void hdUnschedule(unsigned long handle) {
  const Lock lock(self().mutex);
  if (handle != 3) misuse("hdUnschedule of another callback");
  scheduler().callback = nullptr;
}

}  // extern "C"
