#include "server/base/realtime.h"

#include <linux/capability.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace handrail {
namespace {

bool may_lock_without_limit() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3]{};
  if (syscall(SYS_capget, &header, data) == 0 && (data[0].effective & (1u << CAP_IPC_LOCK)) != 0) {
    return true;
  }
  rlimit limit{};
  return getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
}

std::string cause() { return std::string(" (") + std::strerror(errno) + ")"; }

// Under a limit, locking future pages would turn a later allocation into a failure.
std::string lock_memory(bool& locked) {
  if (!may_lock_without_limit()) return "memory not locked (no permission to lock all of it)";
  locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  return locked ? "memory locked" : "memory not locked" + cause();
}

std::string take_fifo(int priority, bool& fifo) {
  const sched_param wanted{priority};
  fifo = sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0;
  return fifo ? "SCHED_FIFO " + std::to_string(priority) : "ordinary scheduling" + cause();
}

std::string refine_timers(bool& fine) {
  fine = prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) == 0;
  return fine ? "timer slack 1 ns" : "default timer slack" + cause();
}

}  // namespace

RealtimeGrant enter_realtime(int priority) {
  RealtimeGrant grant;
  grant.report = lock_memory(grant.memory_locked);
  grant.report += ", " + refine_timers(grant.fine_timers);
  grant.report += ", " + take_fifo(priority, grant.fifo);
  if (grant.fifo) grant.priority = priority;
  return grant;
}

RealtimePermission realtime_permission(int priority) {
  const auto limit_of = [](int resource) {
    rlimit limit{};
    const bool none = getrlimit(resource, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
    return none ? -1L : static_cast<long>(limit.rlim_cur);
  };
  RealtimePermission out;
  out.lock = may_lock_without_limit();
  out.most_priority = limit_of(RLIMIT_RTPRIO);
  const long locked = limit_of(RLIMIT_MEMLOCK);
  out.most_locked_kb = locked < 0 ? locked : locked / 1024;
  sched_param before{};
  const int policy = sched_getscheduler(0);
  if (policy < 0 || sched_getparam(0, &before) != 0) return out;
  const sched_param wanted{priority};
  out.fifo = sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
  if (out.fifo) (void)sched_setscheduler(0, policy, &before);
  return out;
}

std::string realtime_permission_line(const std::string& user) {
  return "printf '" + user + " - rtprio 90\\n" + user +
         " - memlock unlimited\\n' > /etc/security/limits.d/handrail.conf";
}

std::string realtime_advice(std::initializer_list<RealtimeGrant> grants) {
  const auto enough = [](const RealtimeGrant& grant) { return grant.fifo && grant.memory_locked; };
  if (std::all_of(grants.begin(), grants.end(), enough)) return {};
  return "not in real time: late cycles are likelier; to be granted it, as root: " +
         realtime_permission_line("USER") + ", with this user's name for USER, then log in anew";
}

}  // namespace handrail
