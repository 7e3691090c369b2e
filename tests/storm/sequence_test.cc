#include "tests/storm/sequence.h"

#include <gtest/gtest.h>

#include <set>

namespace handrail::storm {
namespace {

TEST(StormSequence, IsTheSameForTheSameSeed) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    EXPECT_EQ(text(draw(seed)), text(draw(seed)));
    EXPECT_NE(text(draw(seed)), text(draw(seed + 1)));
  }
}

TEST(StormSequence, AThousandSeedsHoldEverythingWithinItsRange) {
  std::set<std::string> kinds;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Sequence s = draw(seed);
    EXPECT_TRUE(s.loss == 0.0 || (s.loss >= 0.01 && s.loss <= 0.05)) << s.loss;
    EXPECT_GE(s.acts.size(), 1u);
    EXPECT_LE(s.acts.size(), 3u);
    Nanos sum = 0;
    for (const Act& act : s.acts) {
      sum += act.lasts;
      kinds.insert(std::to_string(static_cast<int>(act.what)) + name(act.who));
      if (act.what == What::kPause) {
        EXPECT_GE(act.lasts, 5 * kMillisecond);
        EXPECT_LE(act.lasts, 5 * kSecond);
      }
      if (act.what == What::kUnplug) {
        EXPECT_GE(act.lasts, 30 * kMillisecond);
        EXPECT_LE(act.lasts, 1600 * kMillisecond);
      }
    }
    EXPECT_LE(sum, 5 * kSecond) << text(s);
  }
  // Four to pause, one to unplug, three to kill, three to terminate, the stop.
  EXPECT_EQ(kinds.size(), 12u);
}

TEST(StormSequence, SaysWhatIsDone) {
  Sequence s;
  s.loss = 0.021;
  s.acts = {{What::kPause, Who::kSlave, 410 * kMillisecond, 183 * kMillisecond, true},
            {What::kStop, Who::kMaster, 0, 0, false}};
  EXPECT_EQ(text(s), "loss 2.1 %; after 0.410 s pause slave 183.0 ms, recover; after 0.000 s stop");
}

}  // namespace
}  // namespace handrail::storm
