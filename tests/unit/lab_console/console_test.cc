#include "server/lab/console/console.h"

#include <gmock/gmock.h>

#include <array>
#include <thread>

namespace handrail {
namespace {

// What is written to a file that is no terminal.
class PlainProgress : public ::testing::Test {
 protected:
  ~PlainProgress() override { std::fclose(file); }
  std::string text() {
    std::array<char, 1000> all{};
    std::rewind(file);
    return {all.data(), std::fread(all.data(), 1, all.size(), file)};
  }
  std::FILE* file = std::tmpfile();
};

TEST_F(PlainProgress, IsALineOnceInAWhileThatNothingWritesOver) {
  {
    Progress progress(file, 100 * kMillisecond);
    progress.show("1 of 3");  // too early to be worth a line
    std::this_thread::sleep_for(std::chrono::milliseconds(110));
    progress.show("2 of 3");
    progress.show("3 of 3");
    progress.clear();
  }
  EXPECT_EQ(text(), "2 of 3\n");
}

TEST_F(PlainProgress, ComesEveryTenSecondsUnlessSaidOtherwise) {
  EXPECT_EQ(Progress::kPlain, 10 * kSecond);
  Progress(file).show("1 of 3");
  EXPECT_EQ(text(), "");
}

TEST(RunUntilCancelled, ReturnsWhatTheWorkDoes) {
  const std::atomic<bool> cancelled = true;  // it still ends in time
  const auto never = [] { return 1; };
  EXPECT_EQ(run_until_cancelled([] { return 7; }, cancelled, never), 7);
}

TEST(RunUntilCancelledDeathTest, EndsTheProgramInTwoSecondsWhenTheWorkDoesNot) {
  const auto run = [] {
    std::atomic<bool> cancelled = false;
    const Nanos raised = monotonic_now() + 100 * kMillisecond;
    std::jthread ctrl_c([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      cancelled = true;
    });
    const auto work = [] {
      std::this_thread::sleep_for(std::chrono::minutes(1));
      return 0;
    };
    (void)run_until_cancelled(work, cancelled, [&] {
      const bool late = monotonic_now() - raised > 2 * kSecond;
      return complain(Status::error(late ? "late" : "cancelled"), kCancelled);
    });
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(run(), ::testing::ExitedWithCode(130), "handrail-lab: cancelled");
}

}  // namespace
}  // namespace handrail
