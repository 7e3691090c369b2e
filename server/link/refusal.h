// What a slave tells a master that it does not take, because another leads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "server/base/fixed_text.h"
#include "server/base/time.h"

namespace handrail {

// Who a master is, such as "process 4711 on this computer": at most 47 bytes.
using LeaderName = FixedText<48>;

// True for 1 to 47 letters, digits, spaces and '-', '_', '.', ':', '@'. Real-time safe.
inline bool is_leader_name(std::string_view name) noexcept {
  return !name.empty() && name.size() < LeaderName().size() &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  std::string_view(" -_.:@").find(c) != std::string_view::npos;
         });
}

// The session that a refusal names whose datagram was of another wire version: nobody's.
inline constexpr std::uint64_t kOfOtherVersion = UINT64_MAX;

struct Refusal {
  std::uint64_t refused_session = 0;  // of the datagram that was refused
  bool retired = false;               // another took that session's place: it never comes back
  LeaderName leader{};                // the master that leads
  Nanos led_for = 0;                  // since its session was accepted, >= 0

  friend bool operator==(const Refusal&, const Refusal&) = default;
};

// True when every field is in its range. Real-time safe.
inline bool sound(const Refusal& refusal) noexcept {
  return refusal.refused_session != 0 && is_leader_name(text_of(refusal.leader)) &&
         refusal.led_for >= 0;
}

// "process 4711 on this computer, for 12 s": who leads, now that `since` has passed.
inline std::string leader_text(const Refusal& refusal, Nanos since) {
  return std::string(text_of(refusal.leader)) + ", for " +
         std::to_string(refusal.led_for / kSecond + since / kSecond) + " s";
}

}  // namespace handrail
