// A stand-in for the vendor's libHD, loaded as that is: the functions with their binary interface,
// and this structure by which a test says what the device does and sees what it was told.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace handrail::test {

struct HdState {
  // What it does; a test sets it under the mutex.
  std::string name = "Default PHANToM";  // of the device; the default one as well
  std::uint32_t init_error = 0;          // raised by hdInitDevice, which then fails
  std::uint32_t start_error = 0;         // raised by hdStartScheduler
  bool turns = true;                     // the scheduler's thread calls
  std::uint32_t tick_error = 0;          // raised in every frame
  std::uint32_t calibration = 0x5000;    // what hdCheckCalibration answers
  bool update_homes = true;              // hdUpdateCalibration makes it calibrated
  std::int32_t styles = 4;
  double temperature = 0.2;
  double nominal_force = 3.3;
  std::int32_t buttons = 0;
  bool frozen = false;                                // its place stands still
  bool not_a_pose = false;                            // the transform is not finite
  std::array<double, 3> target{};                     // where the hand around it wants it [mm]
  std::array<double, 4> turn = {1.0, 0.0, 0.0, 0.0};  // w x y z
  std::array<double, 3> off{};                        // its encoders are wrong by so much [mm]
  int pause_us = 1000;  // between two ticks, but for a jitter as measured

  // A turn in so many begins 20 ms late; 0: none does.
  int stalls = 0;

  // What became of it.
  std::array<double, 3> place{}, speed{};  // [mm], [mm/s]
  std::array<double, 3> force{};           // acting on the hand [N]
  double most_force = 0.0;                 // ever [N]
  // Of a loop that pushes by 0.1 N for a millimetre to the right: turns whose force was that of
  // their own reading, that of the last, and any other.
  std::uint64_t answered = 0, answered_late = 0, unanswered = 0;
  double told_place = 0.0, place_before = 0.0;
  bool output = false;      // the force is switched on
  int enabled = 0;          // times it was
  int updates = 0;          // of the calibration
  std::uint32_t style = 0;  // of the last one
  int open_devices = 0, opened = 0;
  unsigned long rate = 0;
  std::uint16_t priority = 0;
  std::uint64_t ticks = 0;
  std::vector<std::string> misuses;  // calls that the vendor's documentation forbids

  std::vector<std::uint32_t> errors;  // the stack; the newest last
};

struct HdStandIn : HdState {
  std::mutex mutex;
  void reset() {
    const std::lock_guard lock(mutex);
    static_cast<HdState&>(*this) = HdState();
  }
};

// As the test finds it: `hd_stand_in` in the library.
using HdStandInOf = HdStandIn* (*)();

}  // namespace handrail::test
