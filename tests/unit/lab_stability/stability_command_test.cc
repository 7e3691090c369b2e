#include "server/lab/stability/stability_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(StabilityCommand, IsCancelledCleanly) {
  const Printed printed = run({.quick = true}, true);
  EXPECT_EQ(printed.code, kCancelled);
  EXPECT_EQ(printed.out, "");
}

}  // namespace
}  // namespace handrail
