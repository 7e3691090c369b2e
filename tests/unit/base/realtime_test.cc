#include "server/base/realtime.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>

#include <thread>

namespace handrail {
namespace {

// In a thread of its own, so that the test program itself stays ordinary.
template <typename Body>
void in_thread(Body body) {
  std::thread(body).join();
}

TEST(EnterRealtime, ReportsWhatTheThreadReallyGot) {
  in_thread([] {
    const RealtimeGrant grant = enter_realtime(10);
    sched_param param{};
    sched_getparam(0, &param);
    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    EXPECT_EQ(grant.fifo, policy == SCHED_FIFO);
    EXPECT_EQ(grant.priority, param.sched_priority);
    // Some kernels report 0 for a SCHED_FIFO thread, which has no slack at all.
    EXPECT_EQ(grant.fine_timers, prctl(PR_GET_TIMERSLACK, 0, 0, 0, 0) <= 1);
    EXPECT_EQ(grant.report.find("SCHED_FIFO 10") != std::string::npos, grant.fifo);
    EXPECT_EQ(grant.report.find("memory locked") != std::string::npos, grant.memory_locked);
  });
}

TEST(EnterRealtime, ARefusedPriorityIsSaidAndTheThreadGoesOn) {
  in_thread([] {
    const RealtimeGrant grant = enter_realtime(1000);
    EXPECT_FALSE(grant.fifo);
    EXPECT_EQ(grant.priority, 0);
    EXPECT_NE(grant.report.find("ordinary scheduling (Invalid argument)"), std::string::npos)
        << grant.report;
    EXPECT_EQ(sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, SCHED_OTHER);
  });
}

TEST(RealtimePermission, IsWhatAThreadWouldGetAndChangesNothing) {
  in_thread([] {
    const RealtimePermission may = realtime_permission(10);
    EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER) << "as it was";
    EXPECT_FALSE(realtime_permission(1000).fifo) << "there is no such priority";
    const RealtimeGrant got = enter_realtime(10);
    EXPECT_EQ(may.fifo, got.fifo);
    EXPECT_TRUE(may.lock || !got.memory_locked);
  });
}

TEST(RealtimePermission, TheLineForRootNamesTheUserTwice) {
  EXPECT_EQ(realtime_permission_line("eve"),
            "printf 'eve - rtprio 90\\neve - memlock unlimited\\n' > "
            "/etc/security/limits.d/handrail.conf");
}

TEST(RealtimeAdvice, IsGivenWhereAnyThreadLacksWhatMatters) {
  RealtimeGrant all, no_fifo, no_memory;
  all.fifo = all.memory_locked = no_fifo.memory_locked = no_memory.fifo = true;
  EXPECT_EQ(realtime_advice({all, all}), "");
  for (const RealtimeGrant& lacks : {no_fifo, no_memory}) {
    for (const std::string& advice :
         {realtime_advice({lacks, all}), realtime_advice({all, lacks})}) {
      EXPECT_NE(advice.find("/etc/security/limits.d/"), std::string::npos);
      EXPECT_NE(advice.find("rtprio"), std::string::npos);
      EXPECT_NE(advice.find("memlock"), std::string::npos);
    }
  }
}

TEST(EnterRealtime, ThreadsStartedAfterwardsAreOrdinary) {
  in_thread([] {
    (void)enter_realtime(10);
    in_thread([] { EXPECT_EQ(sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, SCHED_OTHER); });
  });
}

}  // namespace
}  // namespace handrail
