#include "devices/net_ft/rdt_client.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

std::array<std::uint8_t, kRdtRecordSize> record(std::uint32_t sequence, std::int32_t fx = 0,
                                                std::uint32_t status = 0) {
  RdtRecord r;
  r.rdt_sequence = sequence;
  r.status = status;
  r.counts = {fx, -2'000'000, 3, 500, -1000, 7};
  return encode_rdt(r);
}

std::vector<std::uint8_t> copy(RdtClient::Bytes bytes) { return {bytes.begin(), bytes.end()}; }

const std::vector<std::uint8_t> kStreamBytes{0x12, 0x34, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00};
const std::vector<std::uint8_t> kStopBytes{0x12, 0x34, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
const std::vector<std::uint8_t> kBiasBytes{0x12, 0x34, 0x00, 0x42, 0x00, 0x00, 0x00, 0x00};

class RdtClientTest : public ::testing::Test {
 protected:
  bool take(std::uint32_t sequence) { return client_.on_datagram(record(sequence), now_, sample_); }

  RdtClient client_{RdtClientOptions{.counts_per_n = 1e6, .counts_per_n_m = 1e3}};
  FtSample sample_;
  Nanos now_ = 0;
};

TEST_F(RdtClientTest, AsksForTheStreamBiasAndStop) {
  EXPECT_EQ(copy(client_.start(0)), kStreamBytes);
  EXPECT_EQ(copy(client_.bias()), kBiasBytes);
  EXPECT_EQ(copy(client_.stop()), kStopBytes);
}

TEST(RdtClientOfOnRobot, TellsPeriodAndFilterBeforeEachStreamAndTakesAnotherBias) {
  RdtClient client({.dialect = RdtDialect::kOnRobot, .period_ms = 2, .filter = 3});
  EXPECT_EQ(copy(client.setting(0)),
            (std::vector<std::uint8_t>{0x12, 0x34, 0x00, 0x82, 0x00, 0x00, 0x00, 0x02}));
  EXPECT_EQ(copy(client.setting(1)),
            (std::vector<std::uint8_t>{0x12, 0x34, 0x00, 0x81, 0x00, 0x00, 0x00, 0x03}));
  EXPECT_TRUE(client.setting(2).empty());
  EXPECT_EQ(copy(client.start(0)), kStreamBytes);
  EXPECT_EQ(copy(client.bias()),
            (std::vector<std::uint8_t>{0x12, 0x34, 0x00, 0x42, 0x00, 0x00, 0x00, 0xff}));
  EXPECT_EQ(copy(client.stop()), kStopBytes);
}

TEST(RdtClientOfOnRobot, TellsNothingThatWasNotSet) {
  RdtClient none({.dialect = RdtDialect::kOnRobot});
  EXPECT_TRUE(none.setting(0).empty());
  RdtClient filter({.dialect = RdtDialect::kOnRobot, .filter = 6});
  EXPECT_EQ(filter.setting(0)[3], 0x81);
  EXPECT_TRUE(filter.setting(1).empty());
  RdtClient ati({.period_ms = 2, .filter = 3});
  EXPECT_TRUE(ati.setting(0).empty());
}

TEST_F(RdtClientTest, GivesCountsInSiUnits) {
  client_.start(0);
  ASSERT_TRUE(client_.on_datagram(record(9, 1'500'000, 4), 0, sample_));
  EXPECT_TRUE(sample_.wrench.force.isApprox(Vec3(1.5, -2.0, 3e-6)));
  EXPECT_TRUE(sample_.wrench.torque.isApprox(Vec3(0.5, -1.0, 0.007)));
  EXPECT_EQ(sample_.sequence, 9u);
  EXPECT_EQ(sample_.status, 4u);
}

// Status codes as ATI's manual gives them (9610-05, table 4.9).
TEST_F(RdtClientTest, TellsAForceBeyondTheRangeFromOtherFaults) {
  client_.start(0);
  std::uint32_t sequence = 0;
  const auto overrange = [&](RdtClient& client, std::uint32_t status) {
    EXPECT_TRUE(client.on_datagram(record(++sequence, 0, status), 0, sample_));
    return sample_.overrange;
  };
  EXPECT_FALSE(overrange(client_, 0));
  EXPECT_TRUE(overrange(client_, 0xC0000000));   // force or torque out of range
  EXPECT_TRUE(overrange(client_, 0x88000000));   // gage out of range
  EXPECT_FALSE(overrange(client_, 0x80000001));  // temperature
  EXPECT_FALSE(overrange(client_, 0x80000004));  // broken gage
  EXPECT_FALSE(overrange(client_, 0xA0000000));  // calibration checksum
  RdtClient onrobot({.dialect = RdtDialect::kOnRobot});
  onrobot.start(0);
  EXPECT_FALSE(overrange(onrobot, 0xC0000000));  // its bits are its own
}

TEST_F(RdtClientTest, NeverGoesBackOrRepeats) {
  client_.start(0);
  EXPECT_TRUE(take(10));
  EXPECT_TRUE(take(12));
  EXPECT_FALSE(take(11));
  EXPECT_FALSE(take(12));
  EXPECT_TRUE(take(13));
  EXPECT_EQ(sample_.sequence, 13u);
  EXPECT_EQ(client_.counters().stale, 2u);
  EXPECT_EQ(client_.counters().records, 3u);
}

TEST_F(RdtClientTest, CountsOnAcrossTheWrapOfTheSequence) {
  client_.start(0);
  EXPECT_TRUE(take(0xfffffffe));
  EXPECT_TRUE(take(0xffffffff));
  EXPECT_TRUE(take(0));
  EXPECT_TRUE(take(1));
  EXPECT_FALSE(take(0xffffffff));
  EXPECT_FALSE(take(0));
}

TEST_F(RdtClientTest, TakesASensorThatBeganItsStreamAnew) {
  client_.start(0);
  EXPECT_TRUE(take(5000));
  EXPECT_FALSE(take(4001));
  EXPECT_TRUE(take(1));
  EXPECT_TRUE(take(2));
}

TEST_F(RdtClientTest, DropsAndCountsWrongSizes) {
  client_.start(0);
  const std::vector<std::uint8_t> bad(35, 0);
  EXPECT_FALSE(client_.on_datagram(bad, 0, sample_));
  EXPECT_FALSE(client_.on_datagram({}, 0, sample_));
  EXPECT_EQ(client_.counters().rejected, 2u);
  EXPECT_EQ(sample_.sequence, 0u);
}

TEST_F(RdtClientTest, AsksAgainAfterAHundredMillisecondsOfSilence) {
  client_.start(0);
  now_ = 40 * kMillisecond;
  ASSERT_TRUE(take(2000));
  EXPECT_TRUE(client_.poll(140 * kMillisecond - 1).empty());
  EXPECT_EQ(copy(client_.poll(140 * kMillisecond)), kStreamBytes);
  EXPECT_TRUE(client_.poll(240 * kMillisecond - 1).empty());
  EXPECT_EQ(copy(client_.poll(240 * kMillisecond)), kStreamBytes);
  // The sensor was switched off and on: its count begins again.
  EXPECT_TRUE(take(1999));
  EXPECT_EQ(client_.counters().requests, 3u);
}

TEST_F(RdtClientTest, OldRecordsDoNotBreakTheSilence) {
  client_.start(0);
  ASSERT_TRUE(take(5));
  now_ = 99 * kMillisecond;
  EXPECT_FALSE(take(5));
  EXPECT_FALSE(client_.poll(100 * kMillisecond).empty());
}

TEST_F(RdtClientTest, IsQuietBeforeStartAndAfterStop) {
  EXPECT_TRUE(client_.poll(kSecond).empty());
  client_.start(kSecond);
  client_.stop();
  EXPECT_TRUE(client_.poll(2 * kSecond).empty());
}

TEST_F(RdtClientTest, DoesNotAllocate) {
  test::NoAllocation guard("an RDT record");
  client_.start(0);
  take(1);
  client_.poll(kSecond);
}

}  // namespace
}  // namespace handrail
