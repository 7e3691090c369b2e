// What the emulated network does at its times, at its edge, and with what nobody at its ends sent.
#include "tests/unit/emulator/network_bench.h"

namespace handrail::emulator {
namespace {

TEST(NetworkTimesTest, AnOutageLosesWhatIsSentInItInItsDirection) {
  NetworkPlan plan;
  plan.to_far.delay = 20 * kMillisecond;
  plan.outages = {{50 * kMillisecond, 80 * kMillisecond, true, false},
                  {100 * kMillisecond, 110 * kMillisecond, true, true}};
  Bench bench(10, plan);
  bench.exchange(200);
  bench.finish();
  EXPECT_EQ(bench.network.counts(Side::kFar).dark, 40u);
  EXPECT_EQ(bench.network.counts(Side::kNear).dark, 10u);
  EXPECT_EQ(bench.far.size(), 160u);
  for (const Got& got : bench.far) {
    EXPECT_FALSE(got.written >= 50 && got.written < 80) << got.written;
    EXPECT_FALSE(got.written >= 100 && got.written < 110) << got.written;
  }
  expect_accounted(bench.network.counts(Side::kFar));
}

TEST(NetworkTimesTest, AnOutageDoesNotDealTheOtherFaultsAnew) {
  NetworkPlan plan;
  plan.to_far.loss = 0.5;
  Bench plain(11, plan);
  plan.outages = {{0, 50 * kMillisecond}};
  Bench dark(11, plan);
  plain.exchange(1000);
  dark.exchange(1000);
  plain.finish();
  dark.finish();
  std::vector<std::uint32_t> kept, after;
  for (const Got& got : plain.far) {
    if (got.written >= 50) kept.push_back(got.written);
  }
  for (const Got& got : dark.far) after.push_back(got.written);
  EXPECT_EQ(after, kept);
}

TEST(NetworkTimesTest, AChangeKeepsTheTimesToComeAndAnotherPlanDropsThem) {
  NetworkPlan plan;
  plan.outages = {{100 * kMillisecond, 110 * kMillisecond}};
  for (const bool changed : {true, false}) {
    Bench bench(12, plan);
    bench.exchange(50);
    if (changed) {
      NetworkPlan more;
      more.outages = {{0, 10 * kMillisecond}};
      bench.network.change(more, 50 * kMillisecond);
    } else {
      bench.network.begin({}, 50 * kMillisecond);
    }
    bench.exchange(100);
    EXPECT_EQ(bench.network.counts(Side::kFar).dark, changed ? 20u : 0u);
  }
}

TEST(NetworkTimesTest, ARebindingAtItsTimeChangesThePortAndOldAnswersAreNobodys) {
  NetworkPlan plan;
  plan.edge.nat = true;
  plan.to_near.delay = 5 * kMillisecond;
  plan.rebinds = {100 * kMillisecond};
  Network network(13);
  network.begin(plan, 0);
  Bytes out(kLongestPacket);
  std::vector<Endpoint> seen;
  int answers = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Nanos now = i * kMillisecond;
    network.send(Side::kNear, numbered(i, near_end(false), far_end(false)), now);
    while (const auto arrived = network.take(now, out)) {
      const std::span<const std::uint8_t> packet = std::span(out).first(arrived->size);
      const auto layout = layout_of(packet);
      ASSERT_TRUE(layout && is_sound(packet, *layout));
      if (arrived->at == Side::kNear) {
        EXPECT_EQ(destination_of(packet, *layout), near_end(false));
        ++answers;
        continue;
      }
      const Endpoint from = source_of(packet, *layout);
      if (seen.empty() || !(seen.back() == from)) seen.push_back(from);
      network.send(Side::kFar, numbered(i, far_end(false), from), now);
    }
  }
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_NE(seen[0].port, seen[1].port);
  // Those to the old port that were under way.
  EXPECT_EQ(network.counts(Side::kNear).nobodys, 5u);
  EXPECT_EQ(answers, 190);
}

TEST(NetworkTimesTest, InjectedPacketsArriveAsTheyAreAndHaveNoNumber) {
  NetworkPlan plan;
  plan.edge.nat = true;
  plan.to_near.loss = 1.0;
  Bench bench(14, plan);
  const Bytes forged = numbered(7, at("192.0.2.9:1"), near_end(false));
  bench.network.inject(Side::kNear, forged, 0);
  bench.finish();
  ASSERT_EQ(bench.near.size(), 1u);
  EXPECT_EQ(bench.near[0].packet, forged);
  EXPECT_EQ(bench.near[0].arrived.number, 0u);
  EXPECT_EQ(bench.near[0].arrived.origin, Origin::kInjected);
  EXPECT_EQ(bench.network.counts(Side::kNear).sent, 0u);
  expect_accounted(bench.network.counts(Side::kNear));
}

TEST(NetworkTimesTest, WhatIsForNeighboursAloneIsIgnored) {
  Bench bench(15);
  EXPECT_EQ(bench.network.send(Side::kNear, numbered(1, near_end(true), at("[ff02::16]:1")), 0),
            0u);
  EXPECT_EQ(bench.network.send(Side::kNear, Bytes{0x45, 0}, 0), 0u);
  bench.finish();
  EXPECT_TRUE(bench.far.empty());
  EXPECT_EQ(bench.network.counts(Side::kFar).ignored, 2u);
  EXPECT_EQ(bench.network.counts(Side::kFar).sent, 0u);
}

}  // namespace
}  // namespace handrail::emulator
