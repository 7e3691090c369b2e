// A log whose reader is slow, gone or back again. The reader is a pipe here.
#include "server/daemon/daemon_log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <string>

#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

class DaemonLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    previous_ = spdlog::default_logger();
    ASSERT_EQ(::pipe(ends_), 0);
    log.emplace("test", ends_[1]);
  }
  void TearDown() override {
    log.reset();
    spdlog::set_default_logger(previous_);
    for (const int end : ends_) {
      if (end >= 0) ::close(end);
    }
  }

  void hang_up() {
    ::close(ends_[0]);
    ends_[0] = -1;
  }
  // Everything that has come so far.
  std::string read_all() {
    ::fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    std::string out;
    char part[4096];
    for (ssize_t n = 0; (n = ::read(ends_[0], part, sizeof part)) > 0;) {
      out.append(part, static_cast<std::size_t>(n));
    }
    return out;
  }
  bool loses(std::uint64_t count) {
    const Nanos give_up = monotonic_now() + 10 * kSecond;
    while (log->lost() < count) {
      if (monotonic_now() > give_up) return false;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return true;
  }

  std::optional<DaemonLog> log;

 private:
  int ends_[2] = {-1, -1};
  std::shared_ptr<spdlog::logger> previous_;
};

TEST_F(DaemonLogTest, ItsLinesComeInOrderWithNameAndLevel) {
  for (int i = 0; i < 100; ++i) spdlog::warn("line {}", i);
  log.reset();
  const std::string text = read_all();
  EXPECT_NE(text.find("[test] [warning] line 0\n"), text.npos) << text;
  EXPECT_LT(text.find("line 98\n"), text.find("line 99\n"));
  EXPECT_NE(text.find("line 99\n"), text.npos);
}

TEST_F(DaemonLogTest, NobodyWaitsForAReaderThatStandsStillAndTheEndDoesNot) {
  const std::string line(1000, 'x');
  const Nanos start = monotonic_now();
  for (int i = 0; i < 5000; ++i) spdlog::info("{} {}", i, line);
  EXPECT_LT(monotonic_now() - start, 10 * kSecond) << "for good, if it waited";
  EXPECT_TRUE(loses(5000 - DaemonLog::kLines - 70)) << "a pipe holds 64 KiB";
  EXPECT_LE(log->lost(), 5000u - DaemonLog::kLines);
  const Nanos end = monotonic_now();
  log.reset();
  EXPECT_LT(monotonic_now() - end, 10 * kSecond) << "for good, if it waited";
  EXPECT_GE(monotonic_now() - end, DaemonLog::kEndPatience);
}

TEST_F(DaemonLogTest, AReaderThatComesBackReadsTheNewestLines) {
  const std::string line(1000, 'x');
  for (int i = 0; i < 5000; ++i) spdlog::info("{} {}", line, i);
  ASSERT_TRUE(loses(1));
  std::string text;
  const Nanos give_up = monotonic_now() + 10 * kSecond;
  while (text.find("x 4999\n") == text.npos && monotonic_now() < give_up) text += read_all();
  EXPECT_NE(text.find("x 4999\n"), text.npos);
  EXPECT_EQ(text.find("x 2500\n"), text.npos) << "newer ones took its place";
}

TEST_F(DaemonLogTest, AReaderThatIsGoneCostsItsLinesAndNothingElse) {
  hang_up();
  for (int i = 0; i < 10; ++i) spdlog::error("nobody reads {}", i);
  EXPECT_TRUE(loses(10));
  EXPECT_EQ(log->lost(), 10u);
}

TEST_F(DaemonLogTest, AFullDiskCostsItsLines) {
  const int full = ::open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  log.emplace("test", full);
  spdlog::error("no room");
  EXPECT_TRUE(loses(1));
  log.reset();
  ::close(full);
}

}  // namespace
}  // namespace handrail
