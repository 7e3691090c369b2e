#include "client/api/cursor_sender.h"

#include <chrono>

#include "server/base/units.h"

namespace handrail {
namespace {

constexpr auto kCursorPeriod = std::chrono::milliseconds(10);
constexpr Nanos kCursorAnswer = kSecond;

pb::Request cursor_order(const Pose& X_MC, std::uint64_t sequence) {
  pb::Request request;
  pb::CursorOrder& cursor = *request.mutable_cursor();
  cursor.set_sequence(sequence);
  cursor.set_held(true);
  const Vec3 place = X_MC.p / kMm, turn = rotation_log(X_MC.q) / kDeg;
  cursor.mutable_position_mm()->Add(place.begin(), place.end());
  cursor.mutable_rotation_deg()->Add(turn.begin(), turn.end());
  return request;
}

}  // namespace

CursorSender::CursorSender(const MasterPlace& master, const std::string& as)
    : client_(master, as), thread_([this] { run(); }) {}

CursorSender::~CursorSender() {
  ends_ = true;
  thread_.join();
}

void CursorSender::set(const Pose& X_MC) {
  const std::lock_guard lock(mutex_);
  X_MC_ = X_MC;
  set_ = true;
}

void CursorSender::run() {
  std::uint64_t sequence = 0;
  auto due = std::chrono::steady_clock::now();
  while (!ends_) {
    due = std::max(due + kCursorPeriod, std::chrono::steady_clock::now());
    std::this_thread::sleep_until(due);
    Pose X_MC;
    {
      const std::lock_guard lock(mutex_);
      if (!set_) continue;
      X_MC = X_MC_;
    }
    // One that is refused or lost is followed by the next; the status shows what came of it.
    (void)client_.call(cursor_order(X_MC, ++sequence), kCursorAnswer);
  }
}

}  // namespace handrail
