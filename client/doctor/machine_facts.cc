#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "client/doctor/gather.h"
#include "server/base/folder_owner.h"
#include "server/base/realtime.h"

namespace handrail {
namespace {

namespace fs = std::filesystem;

// The highest priority that a daemon asks for, the master's haptic thread (master_main.cc).
constexpr int kHighestPriority = 85;

std::string word_in(const fs::path& path) {
  std::string word;
  std::ifstream(path) >> word;
  return word;
}

std::vector<std::string> governors() {
  std::vector<std::string> out;
  std::error_code error;
  for (const fs::directory_entry& entry :
       fs::directory_iterator("/sys/devices/system/cpu", error)) {
    const std::string governor = word_in(entry.path() / "cpufreq/scaling_governor");
    if (!governor.empty() && std::find(out.begin(), out.end(), governor) == out.end()) {
      out.push_back(governor);
    }
  }
  return out;
}

}  // namespace

MachineFacts machine_facts() {
  MachineFacts out;
  out.user = user_entry(::geteuid()).name;
  if (out.user.empty()) out.user = std::to_string(::geteuid());
  const RealtimePermission may = realtime_permission(kHighestPriority);
  out.may_fifo = may.fifo;
  out.may_lock = may.lock;
  out.most_priority = may.most_priority;
  out.most_locked_kb = may.most_locked_kb;
  out.governors = governors();
  out.clock_source = word_in("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  timex state{};  // modes 0: only asked
  if (::adjtimex(&state) >= 0) out.calendar_is_kept = (state.status & STA_UNSYNC) == 0;
  return out;
}

}  // namespace handrail
