#include "devices/rig/tap.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace handrail {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is written as it is in memory");

constexpr std::size_t kSize = sizeof(TapHeader) + Tap::kCapacity * sizeof(TapRecord);

Status failure(const std::string& path, const std::string& why) {
  return Status::error("tap: " + path + ": " + why);
}

bool is_tap(std::ifstream& file, TapHeader& header) {
  const TapHeader expected;
  return file.read(reinterpret_cast<char*>(&header), sizeof(header)) &&
         header.magic == expected.magic && header.record_bytes == expected.record_bytes;
}

}  // namespace

Tap::~Tap() {
  if (memory_ != nullptr) ::munmap(memory_, kSize);
}

Status Tap::open(const std::string& path, Nanos period) {
  TapHeader header;
  if (std::ifstream old(path, std::ios::binary); old && is_tap(old, header)) {
    if (::unlink(path.c_str()) != 0) {
      const std::string why = std::strerror(errno);
      return failure(path, "an older tap, which cannot be removed: " + why);
    }
  }
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file < 0 && errno == EEXIST)
    return failure(path, "exists and is no tap; expected a new file");
  if (file < 0) return failure(path, std::strerror(errno));
  int error = ::posix_fallocate(file, 0, static_cast<off_t>(kSize));
  void* memory = MAP_FAILED;
  if (error == 0) {
    memory = ::mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file, 0);
    error = memory == MAP_FAILED ? errno : 0;
  }
  ::close(file);
  if (error != 0) {
    ::unlink(path.c_str());
    return failure(path, std::strerror(error));
  }
  memory_ = static_cast<std::byte*>(memory);
  header = TapHeader();
  header.capacity = kCapacity;
  header.period = period_ = period;
  std::memcpy(memory_, &header, sizeof(header));
  return Status::ok();
}

void Tap::add(const Controller& controller, Nanos at, Nanos came, bool cable_out) noexcept {
  TapRecord record;
  record.number = ++number_;
  record.at = at;
  const auto bit = [&record](bool on, TapBit which) {
    if (on) record.did = static_cast<std::uint16_t>(record.did | which);
  };
  const std::optional<PeerId> session = controller.session();
  bit(controller.accepted(), kTapAccepted);
  bit(session.has_value(), kTapSession);
  bit(session && session != session_, kTapOpened);
  bit(session_ && session != session_, kTapClosed);
  bit(controller.alarm().kind != AlarmKind::kNone, kTapAlarm);
  bit(cable_out, kTapCableOut);
  session_ = session;
  record.came = static_cast<std::uint16_t>(
      std::clamp<Nanos>((came - (at - period_)) / kMicrosecond, 0, 0xffff));
  record.alarm = static_cast<std::uint8_t>(controller.alarm().kind);
  record.joint = static_cast<std::uint8_t>(controller.alarm().joint);
  const std::uint64_t lost = controller.counters().lost_moves;
  record.lost = static_cast<std::uint16_t>(std::min<std::uint64_t>(lost - lost_, 0xffff));
  lost_ = lost;
  const JointVector measured = controller.arm().measured();
  std::copy_n(controller.arm().target().data(), kJoints, record.target.begin());
  std::copy_n(measured.data(), kJoints, record.measured.begin());
  // Whole again only with the last word.
  auto* slot = memory_ + sizeof(TapHeader) + (record.number - 1) % kCapacity * sizeof(TapRecord);
  std::atomic_ref again(reinterpret_cast<TapRecord*>(slot)->again);
  again.store(0, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_release);
  std::memcpy(slot, &record, offsetof(TapRecord, again));
  again.store(record.number, std::memory_order_release);
}

Result<TapFile> read_tap(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return failure(path, std::strerror(errno));
  TapHeader header;
  if (!is_tap(file, header)) return failure(path, "no tap of a rig");
  TapFile out;
  out.period = header.period;
  for (TapRecord record; file.read(reinterpret_cast<char*>(&record), sizeof(record));) {
    if (record.number != 0 && record.number == record.again) out.records.push_back(record);
  }
  std::sort(out.records.begin(), out.records.end(),
            [](const TapRecord& a, const TapRecord& b) { return a.number < b.number; });
  return out;
}

}  // namespace handrail
