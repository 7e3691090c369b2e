// A log whose reader is slow, gone or back again. The reader is mostly a pipe here.
#include "server/daemon/daemon_log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sched.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

constexpr int kPriority = 1;

class DaemonLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    previous_ = spdlog::default_logger();
    ASSERT_EQ(::pipe(ends_), 0);
    log.emplace("test", kPriority, ends_[1]);
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
  // The log as one that ends up at `fd`.
  void log_to(int fd) {
    log.reset();
    log.emplace("test", kPriority, fd);
  }
  // How long its end takes; `release` lets go who would wait for ever.
  template <typename Release>
  Nanos end(Release release) {
    const Nanos start = monotonic_now();
    auto ended = std::async(std::launch::async, [this] { log.reset(); });
    if (ended.wait_for(std::chrono::seconds(5)) != std::future_status::ready) release();
    ended.wait();
    return monotonic_now() - start;
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

TEST_F(DaemonLogTest, ATerminalThatNobodyReadsFillsUpAndTheEndDoesNotWait) {
  int reader = -1, terminal = -1;
  ASSERT_EQ(::openpty(&reader, &terminal, nullptr, nullptr, nullptr), 0);
  log_to(terminal);
  const std::string line(1000, 'x');
  for (int i = 0; i < 200; ++i) spdlog::info("{}", line);
  sleep_until(monotonic_now() + 100 * kMillisecond);  // till it is full
  EXPECT_LT(end([&] { ::close(reader); }), 2 * kSecond);
  EXPECT_EQ(::fcntl(terminal, F_GETFL) & O_NONBLOCK, 0) << "others have it open too";
  ::close(terminal);
  ::close(reader);
}

// As to a slow disk: poll() promises room, and the write waits all the same. A counter takes eight
// bytes at a time, and room for one is not room for them.
TEST_F(DaemonLogTest, AWriteThatWaitsIsLeftBehindAtTheEnd) {
  const int counter = ::eventfd(0, 0);
  ASSERT_GE(counter, 0);
  log_to(counter);
  spdlog::default_logger()->set_pattern("%v");
  for (int i = 0; i < 100; ++i) spdlog::info("fuller!");
  sleep_until(monotonic_now() + 100 * kMillisecond);  // till it is full
  const auto let_go = [counter] {
    ::fcntl(counter, F_SETFL, O_NONBLOCK);
    for (int i = 0; i < 1000; ++i) {
      eventfd_t count = 0;
      (void)eventfd_read(counter, &count);
      sleep_until(monotonic_now() + 100 * kMicrosecond);
    }
  };
  const Nanos took = end(let_go);
  EXPECT_GT(took, DaemonLog::kEndPatience) << "no write waited";
  EXPECT_LT(took, 2 * kSecond);
  let_go();  // who was left behind comes to his end
}

TEST_F(DaemonLogTest, ASlowReaderGetsWholeLinesAndDoesNotKeepTheEnd) {
  for (int i = 0; i < 1000; ++i) spdlog::info("line {} {}", i, std::string(500, 'x'));
  std::atomic<bool> ended{false};
  std::string text;
  std::thread reader([&] {
    while (!ended) {
      text += read_all().substr(0, 4096);
      sleep_until(monotonic_now() + 20 * kMillisecond);
    }
  });
  EXPECT_LT(end([] {}), 2 * kSecond);
  ended = true;
  reader.join();
  EXPECT_NE(text.find("line 0 "), text.npos);
}

// A thread that waits for the queue's lock must not wait for one that is kept from the processor.
TEST_F(DaemonLogTest, ItsThreadHasThePriorityOfWhoLogs) {
  const auto threads = [] {
    std::set<int> out;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
      out.insert(std::stoi(entry.path().filename()));
    }
    return out;
  };
  log.reset();
  const std::set<int> before = threads();
  log.emplace("test", kPriority);
  int found = 0;
  for (const int thread : threads()) {
    if (before.contains(thread)) continue;
    ++found;
    sched_param got{};
    const Nanos give_up = monotonic_now() + kSecond;
    while (monotonic_now() < give_up && got.sched_priority == 0) ::sched_getparam(thread, &got);
    const sched_param wanted{kPriority};
    if (::sched_setscheduler(thread, SCHED_FIFO, &wanted) != 0) GTEST_SKIP() << "not allowed here";
    EXPECT_EQ(got.sched_priority, kPriority);
  }
  EXPECT_EQ(found, 1);
}

TEST_F(DaemonLogTest, AReaderThatComesBackReadsTheNewestLines) {
  const std::string line(1000, 'x');
  for (int i = 0; i < 5000; ++i) spdlog::info("{} {}", line, i);
  ASSERT_TRUE(loses(1));
  std::string text;
  const Nanos give_up = monotonic_now() + 10 * kSecond;
  while (text.find("x 4999\n") == text.npos && monotonic_now() < give_up) text += read_all();
  EXPECT_NE(text.find("x 4999\n"), text.npos);
  EXPECT_NE(text.find("x 4990\n"), text.npos);
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
  log.emplace("test", kPriority, full);
  spdlog::error("no room");
  EXPECT_TRUE(loses(1));
  log.reset();
  ::close(full);
}

}  // namespace
}  // namespace handrail
