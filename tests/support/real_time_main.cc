// The main of tests that run real programs against the clock. Such a test can fail because the
// machine itself stood still: a virtual machine whose host gives its processors to others does, for
// tens of milliseconds. A test that fails while that happened says nothing of the programs. It is
// run again; after kTries it counts as skipped. One that fails on a machine that ran is a failure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

// A quarter of the 20 ms after which one side misses the other: a rig, a slave and a master can be
// held up one after the other.
constexpr Nanos kStoodStill = 5 * kMillisecond;
constexpr int kTries = 3;
constexpr Nanos kWaitForQuiet = 20 * kSecond;  // 3 tries of 30 s patience still fit into 240 s
constexpr int kNotJudged = 77;                 // tests/CMakeLists.txt: skipped

// One thread on each processor, before all others: what holds it up is not a program of ours.
class Witness {
 public:
  Witness() {
    cpu_set_t ours;
    CPU_ZERO(&ours);
    sched_getaffinity(0, sizeof ours, &ours);
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu)
      if (CPU_ISSET(cpu, &ours)) threads_.emplace_back([this, cpu] { watch(cpu); });
  }
  ~Witness() {
    ended_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Witness(const Witness&) = delete;
  Witness& operator=(const Witness&) = delete;

  // The longest that a processor stood still since this was asked last.
  Nanos longest() { return longest_.exchange(0); }

 private:
  void watch(std::size_t cpu) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(cpu, &one);
    pthread_setaffinity_np(pthread_self(), sizeof one, &one);
    const sched_param first{.sched_priority = 99};
    (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &first);  // else as good as it gets
    while (!ended_) {
      const Nanos due = monotonic_now() + kMillisecond;
      sleep_until(due);
      const Nanos late = monotonic_now() - due;
      Nanos before = longest_;
      while (late > before && !longest_.compare_exchange_weak(before, late)) {
      }
    }
  }

  std::atomic<bool> ended_{false};
  std::atomic<Nanos> longest_{0};
  std::vector<std::thread> threads_;
};

// Parts the failed tests of a run into those of a machine that ran and those to be run again.
class Judge : public ::testing::EmptyTestEventListener {
 public:
  explicit Judge(Witness& witness) : witness_(witness) {}

  std::string again;  // a filter: the tests that the machine disturbed
  bool failed = false;

 private:
  void OnTestStart(const ::testing::TestInfo&) override { (void)witness_.longest(); }
  void OnTestEnd(const ::testing::TestInfo& test) override {
    const Nanos longest = witness_.longest();
    if (!test.result()->Failed()) return;
    if (longest < kStoodStill) {
      failed = true;
      return;
    }
    std::printf("The machine stood still for %.0f ms during this test: it proves nothing.\n",
                static_cast<double>(longest) * 1e-6);
    again += std::string(again.empty() ? "" : ":") + test.test_suite_name() + "." + test.name();
  }

  Witness& witness_;
};

// Until the machine has run for a second, or for as long as that is worth.
void wait_for_quiet(Witness& witness) {
  const Nanos give_up = monotonic_now() + kWaitForQuiet;
  do {
    (void)witness.longest();
    sleep_until(monotonic_now() + kSecond);
  } while (witness.longest() >= kStoodStill && monotonic_now() < give_up);
}

int run_all() {
  Witness witness;
  Judge judge(witness);
  ::testing::UnitTest::GetInstance()->listeners().Append(&judge);
  int code = RUN_ALL_TESTS();
  for (int tried = 1; tried < kTries && !judge.again.empty(); ++tried) {
    std::printf("Once more: %s\n", judge.again.c_str());
    wait_for_quiet(witness);
    GTEST_FLAG_SET(filter, std::exchange(judge.again, ""));
    code = RUN_ALL_TESTS();
  }
  ::testing::UnitTest::GetInstance()->listeners().Release(&judge);
  if (judge.failed) return 1;
  if (judge.again.empty()) return code;
  std::printf("Not judged, after %d tries each: %s\n", kTries, judge.again.c_str());
  return kNotJudged;
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) {
  ::testing::InitGoogleMock(&argc, argv);
  // Who only asks for the names of the tests is not made to wait for threads.
  return GTEST_FLAG_GET(list_tests) ? RUN_ALL_TESTS() : handrail::run_all();
}
