#include "server/lab/stability/stability_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "server/base/clock.h"
#include "server/base/pacer.h"
#include "server/lab/console/console.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Printed {
  int code = 0;
  std::string out, err;
};

Printed run(const StabilityCommand& command, bool cancelled = false) {
  const std::atomic<bool> flag = cancelled;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Printed printed;
  printed.code = run_stability_command(command, flag);
  printed.out = testing::internal::GetCapturedStdout();
  printed.err = testing::internal::GetCapturedStderr();
  return printed;
}

TEST(StabilityCommand, RunsTheCasesWhoseNamesBeginSo) {
  EXPECT_EQ(run({.only = "cycle/K10"}).code, kUsage) << "half a part of a name";
  const Printed list = run({.only = "cycle/K800", .list = true});
  EXPECT_EQ(list.out, "cycle/K800/2Hz/d7\n");
  EXPECT_EQ(list.code, kDone);
  const Printed whole = run({.only = "cycle", .json = true});
  EXPECT_EQ(whole.code, kDone);
  EXPECT_THAT(whole.out, HasSubstr("{\"case\": \"cycle/K800/2Hz/d7\", \"seed\": 1, "));
}

TEST(StabilityCommand, ANameThatIsNoCaseGetsTheNearest) {
  const Printed printed = run({.only = "cycle/K800/2Hz/d8"});
  EXPECT_EQ(printed.code, kUsage);
  EXPECT_THAT(printed.err, HasSubstr("did you mean 'cycle/K800/2Hz/d7'?"));
}

TEST(StabilityCommand, TheQuickFormLeavesTheLongCasesOut) {
  const std::string day = "long-run/contact/24h";
  EXPECT_THAT(run({.only = "long-run", .list = true}).out, HasSubstr(day));
  const Printed quick = run({.quick = true, .list = true});
  EXPECT_THAT(quick.out, Not(HasSubstr(day)));
  EXPECT_THAT(quick.out, HasSubstr("long-run/contact/2min\n"));
  EXPECT_THAT(quick.out, HasSubstr("teleoperation/model/1000ms/clean/middle/K50\n"));
  EXPECT_THAT(quick.out, HasSubstr("arm/end/J6/upper/fast\n"));
}

TEST(StabilityCommand, ANameIsSaidAsOneLineOfPlainText) {
  const Printed printed = run({.only = "fric\ntion\033[31m"});
  EXPECT_EQ(printed.code, kUsage);
  EXPECT_THAT(printed.err, HasSubstr("--case 'fric?tion?[31m': no case begins so"));
}

TEST(StabilityCommand, ALongCaseThatTheQuickFormLeavesOutIsNotCalledUnknown) {
  for (const char* only : {"long-run/contact/24h", "long-run/turns/24h"}) {
    const Printed printed = run({.quick = true, .only = only});
    EXPECT_EQ(printed.code, kUsage);
    EXPECT_THAT(printed.err, HasSubstr("only without --quick"));
    EXPECT_THAT(printed.err, Not(HasSubstr("did you mean")));
  }
}

TEST(StabilityCommand, AFolderThatTakesNoFileIsSaidBeforeAnythingRuns) {
  const Printed printed = run({.only = "friction", .figures = "/proc"});
  EXPECT_EQ(printed.code, kFailed);
  EXPECT_THAT(printed.err, HasSubstr("/proc: cannot write there: "));
  EXPECT_THAT(printed.err, Not(HasSubstr("runs")));
  EXPECT_EQ(printed.out, "");
}

// A day takes minutes.
TEST(StabilityCommand, ADayEndsSoonOnceItIsCancelled) {
  for (const char* only : {"long-run/free/24h", "long-run/turns/24h"}) {
    std::atomic<bool> flag = false;
    const std::jthread soon([&flag] {
      sleep_until(monotonic_now() + 100 * kMillisecond);
      flag = true;
    });
    const Nanos start = monotonic_now();
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    EXPECT_EQ(run_stability_command({.only = only}, flag), kCancelled) << only;
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("cancelled"));
    EXPECT_LT(monotonic_now() - start, 5 * kSecond) << only;
  }
}

TEST(StabilityCommand, IsCancelledCleanly) {
  const Printed printed = run({.quick = true}, true);
  EXPECT_EQ(printed.code, kCancelled);
  EXPECT_EQ(printed.out, "");
}

}  // namespace
}  // namespace handrail
