#include "server/daemon/errand.h"

#include <gtest/gtest.h>

#include <new>
#include <semaphore>
#include <string>

#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

using Words = Result<std::string>;

class ErrandTest : public ::testing::Test {
 protected:
  ~ErrandTest() override { errand_left_behind = false; }

  std::optional<Words> result() {
    const Nanos give_up = monotonic_now() + 10 * kSecond;
    while (monotonic_now() < give_up) {
      if (auto out = errand->poll(nullptr)) return out;
      sleep_until(monotonic_now() + kMillisecond);
    }
    return std::nullopt;
  }
  std::optional<Errand<Words>> errand{std::in_place};
};

TEST_F(ErrandTest, GivesWhatTheWorkGaveOnceAndOneAfterTheOther) {
  for (const std::string word : {"one", "two"}) {
    EXPECT_FALSE(errand->poll([word]() -> Words { return word; }));
    const auto out = result();
    ASSERT_TRUE(out);
    ASSERT_TRUE(*out);
    EXPECT_EQ(**out, word);
  }
}

TEST_F(ErrandTest, WorkForWhichThereIsNoMemoryIsAnError) {
  EXPECT_FALSE(errand->poll([]() -> Words { throw std::bad_alloc(); }));
  const auto out = result();
  ASSERT_TRUE(out);
  EXPECT_FALSE(*out);
}

TEST_F(ErrandTest, NobodyWaitsForWorkThatWaits) {
  const auto gate = std::make_shared<std::binary_semaphore>(0);
  const auto passed = std::make_shared<std::atomic<bool>>(false);
  const auto work = [gate, passed]() -> Words {
    const bool in_time = gate->try_acquire_for(std::chrono::seconds(20));
    *passed = true;
    return std::string(in_time ? "in time" : "too late");
  };
  EXPECT_FALSE(errand->poll(work));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(errand->poll(work));
  const Nanos start = monotonic_now();
  errand.reset();
  EXPECT_LT(monotonic_now() - start, 5 * kSecond);
  EXPECT_FALSE(*passed);
  EXPECT_TRUE(errand_left_behind);
  gate->release();
  while (!*passed) sleep_until(monotonic_now() + kMillisecond);
}

TEST_F(ErrandTest, AnIdleOneLeavesNothingBehind) {
  errand.reset();
  EXPECT_FALSE(errand_left_behind);
}

}  // namespace
}  // namespace handrail
