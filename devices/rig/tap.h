// What the rig's controller did, cycle by cycle, in a file that can be read while the rig runs and
// that outlives it, however it ends.
//
// The file, little-endian: a TapHeader, then `capacity` TapRecords, 128 bytes each, as a ring.
// Record number n, from 1, lies in slot (n - 1) % capacity; cycles that a late rig left out have no
// record, but time passes over them. A record is whole when `number` and `again` are the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "devices/rig/controller.h"
#include "server/base/joints.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

struct TapHeader {
  std::array<char, 8> magic{'H', 'D', 'R', 'L', 'T', 'A', 'P', '2'};
  std::uint32_t record_bytes = 128;
  std::uint32_t capacity = 0;  // records
  Nanos period = 0;            // of the controller's cycle [ns]
  std::array<std::uint8_t, 40> reserved{};
};
static_assert(sizeof(TapHeader) == 64);

// What happened in a cycle, one bit each.
enum TapBit : std::uint16_t {
  kTapAccepted = 1,   // a target was taken over
  kTapSession = 2,    // under external control; without kTapAccepted: held for want of a target
  kTapOpened = 4,     // a session began
  kTapClosed = 8,     // a session ended; with kTapOpened: another peer took it over
  kTapAlarm = 16,     // in alarm: holds, silent
  kTapCableOut = 32,  // cut off from everybody (SIGUSR2)
};

struct TapRecord {
  std::uint64_t number = 0;
  Nanos at = 0;                          // of the cycle, the machine's monotonic clock
  std::uint16_t did = 0;                 // sum of TapBits
  std::uint16_t came = 0;                // the newest command to move, after the cycle before [us]
  std::uint8_t alarm = 0;                // AlarmKind
  std::uint8_t joint = 0;                // 1 to 6: to blame for the alarm; 0: none
  std::uint16_t lost = 0;                // commands to move that were sent since the last record
                                         // and did not arrive
  std::array<double, kJoints> target{};  // that the servos follow from here on [rad]
  std::array<double, kJoints> measured{};  // what the encoders read [rad]
  std::uint64_t again = 0;                 // the number

  bool has(TapBit bit) const noexcept { return (did & bit) != 0; }
};
static_assert(sizeof(TapRecord) == 128);

// Writes the file through mapped memory: add() makes no system call and waits for nobody, but for
// the kernel where it stores a page of the file just then; in a memory-backed folder such as
// /dev/shm it does not.
class Tap {
 public:
  static constexpr std::uint32_t kCapacity = 1 << 16;  // 7.8 min at 7.1 ms, 8 MiB

  Tap() = default;
  ~Tap();
  Tap(const Tap&) = delete;
  Tap& operator=(const Tap&) = delete;

  // Makes the file; an older tap there gives way, whoever reads it keeps it. The error names the
  // file and why it cannot be made: any other file in its place is left alone.
  Status open(const std::string& path, Nanos period);
  bool is_open() const noexcept { return memory_ != nullptr; }

  // The cycle that `controller` ran at `at`; its newest command to move came at `came`. Open.
  // Real-time safe as said above.
  void add(const Controller& controller, Nanos at, Nanos came, bool cable_out) noexcept;

 private:
  std::byte* memory_ = nullptr;
  Nanos period_ = 0;
  std::uint64_t number_ = 0;
  std::uint64_t lost_ = 0;
  std::optional<PeerId> session_;
};

struct TapFile {
  Nanos period = 0;
  std::vector<TapRecord> records;  // the whole ones, oldest first
};

// Reads a tap, of a rig that runs or not. The error names the file and what is wrong with it.
Result<TapFile> read_tap(const std::string& path);

}  // namespace handrail
