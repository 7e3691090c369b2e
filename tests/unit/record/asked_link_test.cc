// Another network under a recorded master.
#include "server/lab/replay/asked_link.h"

#include <gmock/gmock.h>

#include <vector>

namespace handrail {
namespace {

using ::testing::HasSubstr;

// What a master hears of a slave that says a new number each 7 ms, tick by tick; 0: nothing yet.
struct Listening {
  explicit Listening(const std::string& words) : link(*link_words(words)) {}
  void listen(int ms) {
    for (int i = 0; i < ms; ++i, ++now) {
      HapticInput in;
      const bool anew = now % 7 == 0;
      if (anew) ++said;
      in.slave_known = true;
      in.slave.applied_sequence = said;
      in.slave_age = (now % 7) * kMillisecond;
      link.apply(now * kMillisecond, anew, in);
      heard.push_back(in.slave_known ? in.slave.applied_sequence : 0);
      last = in;
    }
  }
  AskedLink link;
  Nanos now = 0;
  std::uint64_t said = 0;
  std::vector<std::uint64_t> heard;
  HapticInput last;
};

TEST(AskedLink, WithoutAnythingIsTheRecordedOne) {
  Listening it("delay=0");
  it.listen(100);
  for (std::size_t i = 0; i < it.heard.size(); ++i) EXPECT_EQ(it.heard[i], 1 + i / 7) << i;
  EXPECT_EQ(it.last.slave_age, 99 % 7 * kMillisecond);
  EXPECT_EQ(it.last.link.loop_age, 0);
}

TEST(AskedLink, ADelayIsOfTheWayThereAndBack) {
  Listening it("delay=50");
  it.listen(300);
  EXPECT_EQ(it.heard[99], 0u);
  for (std::size_t i = 100; i < it.heard.size(); ++i)
    EXPECT_EQ(it.heard[i], 1 + (i - 100) / 7) << i;
  EXPECT_EQ(it.last.link.loop_age, 100 * kMillisecond);
}

TEST(AskedLink, WhatIsLostIsNotHeardAndWhatIsOvertakenNeither) {
  Listening none("loss=100");
  none.listen(100);
  EXPECT_EQ(none.heard.back(), 0u);
  EXPECT_EQ(none.last.link.received_of_100, 0);
  Listening some("loss=30,jitter=40");
  some.listen(7000);
  int news = 0;
  for (std::size_t i = 1; i < some.heard.size(); ++i) {
    ASSERT_GE(some.heard[i], some.heard[i - 1]) << "an older one after a newer";
    news += some.heard[i] != some.heard[i - 1];
  }
  EXPECT_GT(news, 200);
  EXPECT_LT(news, 700);
  EXPECT_EQ(some.last.link.received_of_100, 70);
}

TEST(AskedLink, WordsThatAreNoneAreTold) {
  for (const char* words : {"", "delay", "delay=x", "delay=-1", "delay=6000", "loss=101", "speed=1",
                            "delay=1,delay=2", "delay=nan", "delay=1 loss=2"}) {
    const auto taken = link_words(words);
    ASSERT_FALSE(taken) << words;
    EXPECT_THAT(taken.message(), HasSubstr("expected delay=MS,jitter=MS,loss=PERCENT")) << words;
  }
}

}  // namespace
}  // namespace handrail
