#include "server/base/mailbox.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

// Large enough that a copy takes many instructions.
struct Wide {
  std::array<std::uint64_t, 64> words{};
  static Wide of(std::uint64_t value) {
    Wide w;
    w.words.fill(value);
    return w;
  }
  bool torn() const {
    for (const std::uint64_t word : words) {
      if (word != words[0]) return true;
    }
    return false;
  }
};

TEST(Mailbox, HasNothingBeforeTheFirstValue) {
  Mailbox<int> box;
  int out = 7;
  EXPECT_FALSE(box.take(out));
  EXPECT_EQ(out, 7);
}

TEST(Mailbox, GivesEachValueOnce) {
  Mailbox<int> box;
  int out = 0;
  box.publish(1);
  EXPECT_TRUE(box.take(out));
  EXPECT_EQ(out, 1);
  out = 7;
  EXPECT_FALSE(box.take(out));
  EXPECT_EQ(out, 7);
}

TEST(Mailbox, GivesOnlyTheNewestOfSeveral) {
  Mailbox<int> box;
  int out = 0;
  for (int round = 0; round < 10; ++round) {
    for (int i = 1; i <= round + 1; ++i) box.publish(10 * round + i);
    ASSERT_TRUE(box.take(out));
    EXPECT_EQ(out, 10 * round + round + 1);
    EXPECT_FALSE(box.take(out));
  }
}

TEST(Mailbox, NeverTearsNorGoesBackBetweenThreads) {
  constexpr std::uint64_t kValues = 200'000;
  Mailbox<Wide> box;
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kValues; ++i) box.publish(Wide::of(i));
    done = true;
  });
  std::uint64_t last = 0, torn = 0, backward = 0;
  Wide out;
  for (bool finished = false; !finished;) {
    finished = done;
    while (box.take(out)) {
      torn += out.torn();
      backward += out.words[0] <= last;
      last = out.words[0];
    }
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(backward, 0u);
  EXPECT_EQ(last, kValues) << "the last value published must arrive";
}

TEST(Mailbox, NeverTouchesTheHeap) {
  Mailbox<Wide> box;
  Wide out;
  {
    test::NoAllocation guard("mailbox");
    box.publish(Wide::of(3));
    box.take(out);
  }
  EXPECT_EQ(out.words[63], 3u);
}

}  // namespace
}  // namespace handrail
