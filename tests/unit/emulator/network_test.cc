// The emulated network, in virtual time: each fault does what its level says, real packets stay
// sound, every packet is accounted for, and the same seed does it again.
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <random>
#include <set>

#include "server/base/fnv.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/emulator/network_bench.h"

namespace handrail::emulator {
namespace {

// Four standard deviations of a count of `n` at `share`: by chance one run in 16 000.
double bound(double n, double share) { return 4.0 * std::sqrt(n * share * (1.0 - share)) + 1.0; }

// Drawn anew in each run, and named when it fails.
std::uint64_t drawn_seed() {
  const std::uint64_t seed = std::random_device()();
  ::testing::Test::RecordProperty("seed", std::to_string(seed));
  return seed;
}

TEST(NetworkTest, WithoutFaultsEverythingArrivesAtOnceAsItWas) {
  for (const bool is_6 : {false, true}) {
    Bench bench(1);
    bench.exchange(500, is_6);
    bench.finish();
    ASSERT_EQ(bench.far.size(), 500u);
    ASSERT_EQ(bench.near.size(), 500u);
    for (std::uint32_t i = 0; i < 500; ++i) {
      EXPECT_EQ(bench.far[i].packet, numbered(i, near_end(is_6), far_end(is_6)));
      EXPECT_EQ(bench.far[i].arrived.due, Nanos{i} * kMillisecond);
      EXPECT_EQ(bench.far[i].arrived.number, i + 1);
      EXPECT_EQ(bench.near[i].packet, numbered(i, far_end(is_6), near_end(is_6)));
    }
  }
}

TEST(NetworkTest, EachDirectionHasFaultsOfItsOwn) {
  NetworkPlan plan;
  plan.to_far.delay = 30 * kMillisecond;
  plan.to_near.loss = 1.0;
  Bench bench(2, plan);
  bench.exchange(100);
  bench.finish();
  EXPECT_TRUE(bench.near.empty());
  ASSERT_EQ(bench.far.size(), 100u);
  for (const Got& got : bench.far) {
    EXPECT_EQ(got.arrived.due, (got.written + 30) * kMillisecond);
  }
}

TEST(NetworkTest, SharesAreThoseOfThePlanAtADrawnSeed) {
  constexpr double kCount = 20'000;
  const std::uint64_t seed = drawn_seed();
  SCOPED_TRACE(seed);
  NetworkPlan plan;
  plan.to_far.loss = 0.1;
  plan.to_far.duplicate = 0.25;
  plan.to_far.corrupt = 0.05;
  plan.to_far.replay = 0.5;
  plan.to_near.burst_enter = 0.05;
  plan.to_near.burst_leave = 0.25;
  Bench bench(seed, plan);
  bench.exchange(static_cast<std::uint32_t>(kCount));
  bench.finish();
  const Counts far = bench.network.counts(Side::kFar), near = bench.network.counts(Side::kNear);
  EXPECT_NEAR(static_cast<double>(far.lost), 0.1 * kCount, bound(kCount, 0.1));
  EXPECT_NEAR(static_cast<double>(far.duplicated), 0.225 * kCount, bound(kCount, 0.225));
  EXPECT_NEAR(static_cast<double>(far.corrupted), 0.045 * kCount, bound(kCount, 0.045));
  EXPECT_NEAR(static_cast<double>(far.replayed), 0.5 * kCount, bound(kCount, 0.5));
  // About 833 bursts of 4 +- 3.5: their number and their lengths both vary.
  EXPECT_NEAR(static_cast<double>(near.lost), kCount / 6.0, 4.0 * 4.0 * std::sqrt(2.0 * 833.0));
  expect_accounted(far);
  expect_accounted(near);
}

TEST(NetworkTest, JitterStaysInItsBandAndKeepsTheOrderUnlessToldOtherwise) {
  for (const double reorder : {0.0, 0.3}) {
    NetworkPlan plan;
    plan.to_far.delay = 50 * kMillisecond;
    plan.to_far.jitter = 20 * kMillisecond;
    plan.to_far.reorder = reorder;
    Bench bench(4, plan);
    bench.exchange(5000);
    bench.finish();
    ASSERT_EQ(bench.far.size(), 5000u);
    int behind = 0;
    std::uint32_t newest = 0;
    for (const Got& got : bench.far) {
      const Nanos took = got.arrived.due - Nanos{got.written} * kMillisecond;
      EXPECT_GE(took, 30 * kMillisecond);
      EXPECT_LE(took, 70 * kMillisecond);
      behind += got.written < newest;
      newest = std::max(newest, got.written);
    }
    EXPECT_EQ(behind > 0, reorder > 0.0);
  }
}

TEST(NetworkTest, CorruptedPacketsAreSoundButNeverTheOnesSent) {
  const std::uint64_t seed = drawn_seed();
  SCOPED_TRACE(seed);
  for (const bool is_6 : {false, true}) {
    NetworkPlan plan;
    plan.to_far.corrupt = plan.to_near.corrupt = 1.0;
    plan.to_far.corrupt_bits = 64;
    plan.to_near.corrupt_bits = 1;
    Bench bench(seed, plan);
    bench.exchange(2000, is_6);
    bench.finish();
    ASSERT_EQ(bench.far.size(), 2000u);
    ASSERT_EQ(bench.near.size(), 2000u);
    for (std::uint32_t i = 0; i < 2000; ++i) {
      for (const Got& got : {bench.far[i], bench.near[i]}) {
        const bool at_far = got.arrived.at == Side::kFar;
        const Bytes sent = at_far ? numbered(i, near_end(is_6), far_end(is_6))
                                  : numbered(i, far_end(is_6), near_end(is_6));
        const auto layout = layout_of(got.packet);
        ASSERT_TRUE(layout.has_value());
        EXPECT_EQ(got.arrived.origin, Origin::kCorrupt);
        EXPECT_TRUE(is_sound(got.packet, *layout));
        // All but the transport's checksum and the payload is as it was.
        const auto head = static_cast<std::ptrdiff_t>(layout->transport + 6);
        EXPECT_TRUE(std::equal(sent.begin(), sent.begin() + head, got.packet.begin()));
        int turned = 0;
        for (std::size_t k = layout->body; k < sent.size(); ++k) {
          turned += std::popcount(static_cast<unsigned>(sent[k] ^ got.packet[k]));
        }
        EXPECT_GE(turned, 1);
        EXPECT_LE(turned, at_far ? 64 : 1);
      }
    }
  }
}

TEST(NetworkTest, DamagedCopiesComeBesideWhatWasSentAndAreCounted) {
  NetworkPlan plan;
  plan.to_far.corrupt_copies = 2.5;
  Bench bench(1, plan);
  bench.exchange(1000, false);
  bench.finish();
  int genuine = 0, damaged = 0;
  for (const Got& got : bench.far) {
    const auto layout = layout_of(got.packet);
    ASSERT_TRUE(layout && is_sound(got.packet, *layout));
    const bool same = got.packet == numbered(static_cast<std::uint32_t>(got.arrived.number - 1),
                                             near_end(false), far_end(false));
    EXPECT_EQ(same, got.arrived.origin == Origin::kGenuine);
    (same ? genuine : damaged) += 1;
  }
  EXPECT_EQ(genuine, 1000);
  EXPECT_NEAR(damaged, 2500, 100);
  const Counts counts = bench.network.counts(Side::kFar);
  EXPECT_EQ(counts.corrupted, static_cast<std::uint64_t>(damaged));
  EXPECT_EQ(counts.sent + counts.duplicated, counts.delivered);
  EXPECT_EQ(bench.near.size(), 1000u);
}

TEST(NetworkTest, ATcpSegmentIsCorruptedSoundlyAndAnAcknowledgementNotAtAll) {
  NetworkPlan plan;
  plan.to_far.corrupt = 1.0;
  Bench bench(6, plan);
  bench.network.send(Side::kNear, tcp_segment(100), 0);
  bench.network.send(Side::kNear, tcp_segment(0), 0);
  bench.finish();
  ASSERT_EQ(bench.far.size(), 2u);
  EXPECT_NE(bench.far[0].packet, tcp_segment(100));
  EXPECT_EQ(bench.far[1].packet, tcp_segment(0));
  for (const Got& got : bench.far) {
    const auto layout = layout_of(got.packet);
    EXPECT_TRUE(layout && is_sound(got.packet, *layout));
  }
  EXPECT_EQ(bench.network.counts(Side::kFar).corrupted, 1u);
}

TEST(NetworkTest, DuplicatesAndReplaysAreTheBytesSentAndSaySo) {
  NetworkPlan plan;
  plan.to_far.duplicate = 1.0;
  plan.to_far.replay = 2.0;
  Bench bench(7, plan);
  bench.exchange(300);
  bench.finish();
  int genuine = 0, twice = 0, replayed = 0;
  for (const Got& got : bench.far) {
    EXPECT_EQ(got.packet, numbered(got.written, near_end(false), far_end(false)));
    EXPECT_EQ(got.arrived.number, got.written + 1);
    genuine += got.arrived.origin == Origin::kGenuine;
    twice += got.arrived.origin == Origin::kDuplicate;
    replayed += got.arrived.origin == Origin::kReplay;
  }
  EXPECT_EQ(genuine, 300);
  EXPECT_EQ(twice, 300);
  EXPECT_EQ(replayed, 600);
}

// A packet is 92 bytes: 736 bits, which at 368 kbit/s take 2 ms, twice as long as until the next.
TEST(NetworkTest, ARateLimitLetsItsRateThroughAndItsQueueHasAnEnd) {
  NetworkPlan plan;
  plan.to_far.rate_bps = 368'000;
  plan.to_far.queue = 100 * kMillisecond;
  Bench bench(8, plan);
  bench.exchange(2000);
  bench.finish();
  EXPECT_NEAR(static_cast<double>(bench.far.size()), 1051.0, 2.0);
  for (std::size_t i = 1; i < bench.far.size(); ++i) {
    EXPECT_GE(bench.far[i].arrived.due - bench.far[i - 1].arrived.due, 2 * kMillisecond);
    EXPECT_LE(bench.far[i].arrived.due - Nanos{bench.far[i].written} * kMillisecond,
              102 * kMillisecond);
  }
  EXPECT_EQ(bench.network.counts(Side::kFar).overflow, 2000 - bench.far.size());
  expect_accounted(bench.network.counts(Side::kFar));
}

TEST(NetworkTest, MoreThanCanBeUnderWayIsDroppedAndCounted) {
  NetworkPlan plan;
  plan.to_far.delay = kSecond;
  Bench bench(9, plan);
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    bench.network.send(Side::kNear, numbered(i, near_end(false), far_end(false)), 0);
  }
  bench.finish();
  EXPECT_EQ(bench.far.size(), 8192u);
  expect_accounted(bench.network.counts(Side::kFar));
}

NetworkPlan everything() {
  NetworkPlan plan;
  LinkFaults& way = plan.to_far;
  way.delay = 20 * kMillisecond;
  way.jitter = 15 * kMillisecond;
  way.loss = 0.1;
  way.burst_enter = 0.01;
  way.burst_leave = 0.2;
  way.duplicate = 0.2;
  way.reorder = 0.2;
  way.reorder_by = 5 * kMillisecond;
  way.replay = 0.5;
  way.corrupt = 0.1;
  way.rate_bps = 700'000;
  plan.to_near = way;
  plan.edge = {.nat = true, .idle = kSecond};
  plan.rebinds = {500 * kMillisecond, kSecond};
  plan.roams = {1500 * kMillisecond};
  plan.outages = {{200 * kMillisecond, 250 * kMillisecond}};
  return plan;
}

// Of what arrived at near, and at far, where the edge draws nothing.
std::array<std::uint64_t, 2> fingerprints(std::uint64_t seed) {
  NetworkPlan plan = everything();
  plan.edge.nat = false;
  plan.roams.clear();
  Bench bench(seed, plan);
  bench.exchange(2000);
  bench.finish();
  Fnv near, far;
  for (const Got& one : bench.near) near.u64(one.written).u64(one.packet.size());
  for (const Got& one : bench.near) near.u64(static_cast<std::uint64_t>(one.arrived.due));
  for (const Got& one : bench.far) far.u64(static_cast<std::uint64_t>(one.arrived.due));
  for (const Got& one : bench.far) {
    for (std::size_t i = 28; i < one.packet.size(); ++i) far.u64(one.packet[i]);
  }
  expect_accounted(bench.network.counts(Side::kFar));
  expect_accounted(bench.network.counts(Side::kNear));
  return {near.value(), far.value()};
}

// Ports that near is seen with.
std::set<std::uint16_t> ports(std::uint64_t seed) {
  Bench bench(seed, everything());
  bench.exchange(2000);
  std::set<std::uint16_t> out;
  for (const Got& one : bench.far) {
    const auto layout = layout_of(one.packet);
    if (layout) out.insert(source_of(one.packet, *layout).port);
  }
  return out;
}

TEST(NetworkTest, TheSameSeedDoesTheSameAndAnotherSomethingElse) {
  const std::uint64_t seed = drawn_seed();
  SCOPED_TRACE(seed);
  const auto once = fingerprints(seed), again = fingerprints(seed), another = fingerprints(~seed);
  EXPECT_EQ(once, again);
  EXPECT_NE(once[0], another[0]);
  EXPECT_NE(once[1], another[1]);
  EXPECT_EQ(ports(seed), ports(seed));
  EXPECT_NE(ports(seed), ports(~seed));
}

// A packet that waits for memory is late.
TEST(NetworkTest, PassesPacketsOnWithoutTouchingTheHeap) {
  const auto network = std::make_unique<Network>(16);
  NetworkPlan plan = everything();
  plan.edge.nat = false;
  network->begin(plan, 0);
  const Bytes packet = numbered(1, near_end(false), far_end(false));
  Bytes out(kLongestPacket);
  test::NoAllocation guard("packets through the emulated network");
  for (Nanos now = 0; now < 5 * kSecond; now += kMillisecond) {
    (void)network->send(Side::kNear, packet, now);
    while (network->take(now, out)) {
    }
  }
}

}  // namespace
}  // namespace handrail::emulator
