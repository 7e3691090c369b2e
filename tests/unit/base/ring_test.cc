#include "server/base/ring.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace handrail {
namespace {

TEST(Ring, IsEmptyAtFirstAndLeavesTheOutputAlone) {
  Ring<int, 4> ring;
  int out = 7;
  EXPECT_FALSE(ring.pop(out));
  EXPECT_EQ(out, 7);
}

TEST(Ring, RefusesWhenFullAndOverwritesNothing) {
  Ring<int, 4> ring;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(99));
  int out = -1;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(out));
    EXPECT_EQ(out, i);
  }
  EXPECT_FALSE(ring.pop(out));
}

TEST(Ring, HasRoomAgainAfterEachPop) {
  Ring<int, 2> ring;
  int out = -1;
  EXPECT_TRUE(ring.push(0));
  for (int i = 1; i < 100; ++i) {
    EXPECT_TRUE(ring.push(i));
    EXPECT_FALSE(ring.push(-5));
    ASSERT_TRUE(ring.pop(out));
    EXPECT_EQ(out, i - 1);
  }
}

TEST(Ring, DeliversEverythingInOrderBetweenThreads) {
  constexpr std::uint64_t kValues = 200'000;
  using Row = std::array<std::uint64_t, 16>;
  Ring<Row, 64> ring;
  std::thread producer([&ring] {
    Row value;
    for (std::uint64_t i = 0; i < kValues;) {
      value.fill(i);
      if (ring.push(value)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t wrong = 0;
  Row out;
  for (std::uint64_t i = 0; i < kValues;) {
    if (!ring.pop(out)) {
      std::this_thread::yield();
      continue;
    }
    for (const std::uint64_t word : out) wrong += word != i;
    ++i;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_FALSE(ring.pop(out));
}

}  // namespace
}  // namespace handrail
