// Networks by name and from text: what is written is what is in force, and errors name the place.
#include "tests/emulator/network_io.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace handrail::emulator {
namespace {

std::string error_in(const std::string& text) {
  NetworkPlan plan;
  return change_network("n", text, plan).message();
}

TEST(NetworkIoTest, ANameGivesTheLabsNetworkBothWays) {
  ASSERT_GT(known_networks().size(), 1u);
  for (const KnownNetwork& known : known_networks()) {
    const auto loaded = load_network(std::string(known.name));
    ASSERT_TRUE(loaded.is_ok()) << loaded.message();
    for (const LinkFaults& way : {loaded->to_far, loaded->to_near}) {
      EXPECT_EQ(way.delay, known.way.delay);
      EXPECT_EQ(way.jitter, known.way.jitter);
      EXPECT_EQ(way.loss, known.way.loss);
      EXPECT_EQ(way.rate_bps, known.way.rate_bps);
    }
  }
}

TEST(NetworkIoTest, AFileGivesEveryFieldToTheWayItNames) {
  const TempFolder folder;
  const auto loaded = load_network(folder.write("a.network", R"(
    both { delay_ms: 50 jitter_ms: 20.5 loss: 0.25 reorder: 0.5 }
    to_far { loss: 0.125 burst_enter: 0.01 burst_leave: 0.2 duplicate: 0.3 reorder_by_ms: 5 }
    to_near { replay: 2.5 corrupt: 0.75 corrupt_bits: 64 corrupt_copies: 3.5 rate_kbit_s: 64 queue_ms: 250 }
    outage { from_s: 1 for_s: 0.5 }
    outage { for_s: 2 way: TO_NEAR }
    edge { nat: true idle_s: 30 rebind_at_s: [5, 10] roam_at_s: 7 })"));
  ASSERT_TRUE(loaded.is_ok()) << loaded.message();
  const LinkFaults &far = loaded->to_far, &near = loaded->to_near;
  EXPECT_EQ(far.delay, 50 * kMillisecond);
  EXPECT_EQ(near.jitter, 20'500 * kMicrosecond);
  EXPECT_EQ(far.loss, 0.125);
  EXPECT_EQ(near.loss, 0.25);
  EXPECT_EQ(near.reorder, 0.5);
  EXPECT_EQ(far.burst_enter, 0.01);
  EXPECT_EQ(far.burst_leave, 0.2);
  EXPECT_EQ(near.burst_leave, 1.0);
  EXPECT_EQ(far.duplicate, 0.3);
  EXPECT_EQ(far.reorder_by, 5 * kMillisecond);
  EXPECT_EQ(near.replay, 2.5);
  EXPECT_EQ(near.corrupt, 0.75);
  EXPECT_EQ(near.corrupt_bits, 64u);
  EXPECT_EQ(near.corrupt_copies, 3.5);
  EXPECT_EQ(far.corrupt_copies, 0.0);
  EXPECT_EQ(far.corrupt_bits, 8u);
  EXPECT_EQ(near.rate_bps, 64'000);
  EXPECT_EQ(near.queue, 250 * kMillisecond);
  ASSERT_EQ(loaded->outages.size(), 2u);
  EXPECT_EQ(loaded->outages[0].from, kSecond);
  EXPECT_EQ(loaded->outages[0].until, 1500 * kMillisecond);
  EXPECT_TRUE(loaded->outages[0].to_far && loaded->outages[0].to_near);
  EXPECT_TRUE(!loaded->outages[1].to_far && loaded->outages[1].to_near);
  EXPECT_TRUE(loaded->edge.nat);
  EXPECT_EQ(loaded->edge.idle, 30 * kSecond);
  EXPECT_EQ(loaded->rebinds, (std::vector<Nanos>{5 * kSecond, 10 * kSecond}));
  EXPECT_EQ(loaded->roams, (std::vector<Nanos>{7 * kSecond}));
}

TEST(NetworkIoTest, AChangeKeepsWhatItDoesNotName) {
  NetworkPlan plan;
  ASSERT_TRUE(change_network("n", "both { delay_ms: 50 loss: 0.5 } outage { for_s: 1 }", plan));
  ASSERT_TRUE(change_network("n", "to_far { loss: 0 } edge { nat: true }", plan));
  EXPECT_EQ(plan.to_far.delay, 50 * kMillisecond);
  EXPECT_EQ(plan.to_far.loss, 0.0);
  EXPECT_EQ(plan.to_near.loss, 0.5);
  EXPECT_TRUE(plan.edge.nat);
  EXPECT_TRUE(plan.outages.empty());
  const Status wrong = change_network("n", "to_far { loss: 0.25 } to_near { loss: 2 }", plan);
  EXPECT_FALSE(wrong.is_ok());
  EXPECT_EQ(plan.to_far.loss, 0.0);
}

TEST(NetworkIoTest, ErrorsNamePlaceValueAndWhatWasExpected) {
  EXPECT_EQ(error_in("both {\n  los: 1 }"),
            "n:2:3: field 'both.los': no such field; did you mean 'loss'?");
  EXPECT_EQ(error_in("to_far { loss: 1.5 }"), "n:1:10: field 'to_far.loss': 1.5 is outside 0 to 1");
  EXPECT_EQ(error_in("to_far { delay_ms: nan }"),
            "n:1:10: field 'to_far.delay_ms': nan is not a finite number");
  EXPECT_EQ(error_in("outage { from_s: 1 }"),
            "n:1:1: field 'outage[0].for_s': missing, but required");
  EXPECT_EQ(error_in("outage { for_s: 1 way: UP }"),
            "n:1:24: field 'outage.way': UP is not one of BOTH, TO_FAR, TO_NEAR");
  EXPECT_EQ(error_in("to_near { corrupt_bits: 0 }"),
            "n:1:11: field 'to_near.corrupt_bits': 0 is outside 1 to 64");
  EXPECT_EQ(error_in("edge { idle_s: 3 }"),
            "n:1:8: field 'edge.idle_s': without nat there are no ports to give up, expected nat: "
            "true");
  EXPECT_EQ(load_network("netcod").message(),
            "'netcod': neither a file nor a network's name; did you mean 'netcode'?");
}

}  // namespace
}  // namespace handrail::emulator
