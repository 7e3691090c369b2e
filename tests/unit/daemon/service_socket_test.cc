#include "server/daemon/service_socket.h"

#include <gtest/gtest.h>

#include "tests/support/notify_socket.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::NotifySocket;

TEST(ServiceSocket, SaysReadyStoppingAndThatTheLoopRuns) {
  const TempFolder folder;
  NotifySocket manager(folder.path() + "/notify", "40000");
  ServiceSocket notice;
  notice.ready();
  EXPECT_EQ(manager.next(kSecond), "READY=1");
  int signs = 0;
  for (Nanos t = 0; t < 100 * kMillisecond; t += kMillisecond) {
    notice.tick(t, true);
    if (manager.next(0) == "WATCHDOG=1") ++signs;
  }
  EXPECT_EQ(signs, 10);  // four in 40 ms
  for (Nanos t = 100 * kMillisecond; t < 200 * kMillisecond; t += kMillisecond) {
    notice.tick(t, false);
    EXPECT_EQ(manager.next(0), "");
  }
  notice.tick(200 * kMillisecond, true);
  EXPECT_EQ(manager.next(kSecond), "WATCHDOG=1");
  notice.stopping();
  EXPECT_EQ(manager.next(kSecond), "STOPPING=1");
}

TEST(ServiceSocket, AWatchdogThatAsksForLittleHearsOfItEvery20Milliseconds) {
  const TempFolder folder;
  NotifySocket manager(folder.path() + "/notify", "30000000");
  ServiceSocket notice;
  int signs = 0;
  for (Nanos t = 0; t < 200 * kMillisecond; t += kMillisecond) {
    notice.tick(t, true);
    if (manager.next(0) == "WATCHDOG=1") ++signs;
  }
  EXPECT_EQ(signs, 10);
}

TEST(ServiceSocket, WithoutAManagerOrAWatchdogItIsSilent) {
  {
    ServiceSocket nobody;
    nobody.ready();
    nobody.tick(0, true);
  }
  const TempFolder folder;
  for (const char* us : {"", "0", "-5", "soon"}) {
    NotifySocket manager(folder.path() + "/notify" + us, us);
    ServiceSocket notice;
    for (Nanos t = 0; t < kSecond; t += kMillisecond) notice.tick(t, true);
    EXPECT_EQ(manager.next(0), "") << us;
  }
}

TEST(ServiceSocket, AManagerThatDoesNotReadKeepsNobodyWaiting) {
  const TempFolder folder;
  NotifySocket manager(folder.path() + "/notify", "1000");
  ServiceSocket notice;
  for (Nanos t = 0; t < 100 * kSecond; t += kMillisecond) notice.tick(t, true);
  EXPECT_EQ(manager.next(0), "WATCHDOG=1");
}

}  // namespace
}  // namespace handrail
