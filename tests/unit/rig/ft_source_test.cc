#include "devices/rig/ft_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

constexpr PeerId kFtPc = 7;

FtSourceOptions quiet() {
  FtSourceOptions options;
  options.noise_n = 0.0;
  options.noise_n_m = 0.0;
  return options;
}

Wrench wrench(double fx, double tz) { return {{fx, 0.0, 0.0}, {0.0, 0.0, tz}}; }

// One period; the record it sent.
std::optional<RdtRecord> next(FtSource& source) {
  source.tick();
  if (!source.record()) return std::nullopt;
  return decode_rdt_record(source.record()->bytes);
}

void ask(FtSource& source, RdtCommand command, std::uint32_t samples = 0, PeerId from = kFtPc) {
  source.on_datagram(encode_rdt(RdtRequest{command, samples}), from);
}

TEST(FtSource, StreamsFromTheRequestToTheStop) {
  FtSource source(quiet());
  EXPECT_FALSE(next(source));
  ask(source, RdtCommand::kStream);
  for (std::uint32_t i = 1; i <= 3; ++i) {
    const auto record = next(source);
    ASSERT_TRUE(record);
    EXPECT_EQ(record->rdt_sequence, i);
    EXPECT_EQ(record->ft_sequence, i + 1) << "the sensor counts on its own";
    EXPECT_EQ(record->status, 0u);
    EXPECT_EQ(source.record()->to, kFtPc);
  }
  ask(source, RdtCommand::kStop);
  EXPECT_FALSE(next(source));
}

TEST(FtSource, EndsAStreamOfAGivenLength) {
  FtSource source(quiet());
  ask(source, RdtCommand::kStream, 2);
  EXPECT_TRUE(next(source));
  EXPECT_TRUE(next(source));
  EXPECT_FALSE(next(source));
}

TEST(FtSource, ServesWhoeverAskedLast) {
  FtSource source(quiet());
  ask(source, RdtCommand::kStream, 0, 1);
  next(source);
  ask(source, RdtCommand::kStream, 0, 2);
  EXPECT_EQ(next(source)->rdt_sequence, 1u);
  EXPECT_EQ(source.record()->to, 2u);
}

TEST(FtSource, GivesTheWrenchInItsCounts) {
  FtSourceOptions options = quiet();
  options.counts_per_n = 1000.0;
  options.counts_per_n_m = 500.0;
  FtSource source(options);
  source.set_wrench(wrench(-12.5, 3.0));
  ask(source, RdtCommand::kStream);
  const std::array<std::int32_t, 6> expected{-12500, 0, 0, 0, 0, 1500};
  EXPECT_EQ(next(source)->counts, expected);
}

TEST(FtSource, TakesThePresentReadingAsZeroOnBias) {
  FtSource source(quiet());
  source.set_wrench(wrench(5.0, 1.0));
  ask(source, RdtCommand::kStream);
  ask(source, RdtCommand::kBias);
  EXPECT_EQ(next(source)->counts, (std::array<std::int32_t, 6>{}));
  source.set_wrench(wrench(6.5, 1.0));
  EXPECT_EQ(next(source)->counts[0], 1'500'000);
}

TEST(FtSource, SaturatesAtItsRangeAndSaysSo) {
  FtSource source(quiet());
  ask(source, RdtCommand::kStream);
  source.set_wrench(wrench(1000.0, -100.0));
  EXPECT_EQ(next(source)->status, 0u);
  source.set_wrench(wrench(-1000.5, 0.0));
  auto record = next(source);
  EXPECT_EQ(record->status, kRdtOverrange | kRdtError);
  EXPECT_EQ(record->counts[0], -1'000'000'000);
  source.set_wrench(wrench(0.0, 100.5));
  EXPECT_EQ(next(source)->status, kRdtOverrange | kRdtError);
  source.set_wrench(wrench(1.0, 0.0));
  EXPECT_EQ(next(source)->status, 0u);
}

TEST(FtSource, KeepsCountsInsideTheirIntegers) {
  FtSourceOptions options = quiet();
  options.counts_per_n = 1e9;
  FtSource source(options);
  ask(source, RdtCommand::kStream);
  source.set_wrench(wrench(900.0, 0.0));
  EXPECT_EQ(next(source)->counts[0], std::numeric_limits<std::int32_t>::max());
  source.set_wrench(wrench(-900.0, 0.0));
  EXPECT_EQ(next(source)->counts[0], std::numeric_limits<std::int32_t>::min());
}

TEST(FtSource, ReadsANonFiniteWrenchAsSaturated) {
  FtSource source(quiet());
  ask(source, RdtCommand::kStream);
  source.set_wrench(wrench(std::numeric_limits<double>::quiet_NaN(), 0.0));
  ask(source, RdtCommand::kBias);
  EXPECT_EQ(next(source)->status, kRdtOverrange | kRdtError);
  source.set_wrench(wrench(1.0, 0.0));
  EXPECT_EQ(next(source)->counts[0], 1'000'000) << "a bias on nonsense changes nothing";
}

TEST(FtSource, HasWhiteNoiseOfTheConfiguredSize) {
  FtSource source(FtSourceOptions{});
  ask(source, RdtCommand::kStream);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kRecords = 20'000;
  for (int i = 0; i < kRecords; ++i) {
    const double fz = next(source)->counts[2] / 1e6;
    sum += fz;
    squares += fz * fz;
  }
  // Five standard deviations of the estimates.
  EXPECT_NEAR(sum / kRecords, 0.0, 0.0018);
  EXPECT_NEAR(std::sqrt(squares / kRecords), 0.05, 0.00125);
}

TEST(FtSource, CountsWhatIsNoRequest) {
  FtSource source(quiet());
  const std::array<std::uint8_t, 8> garbage{1, 2, 3, 4, 5, 6, 7, 8};
  source.on_datagram(garbage, kFtPc);
  source.on_datagram({}, kFtPc);
  EXPECT_EQ(source.ignored(), 2u);
  EXPECT_FALSE(next(source));
}

TEST(FtSource, TheSwitchDropsItsShareOfTheRecords) {
  FtSourceOptions options = quiet();
  options.drop_share = 0.25;
  FtSource source(options);
  while (!source.listener()) ask(source, RdtCommand::kStream);
  int records = 0;
  std::uint32_t newest = 0;
  constexpr int kPeriods = 20'000;
  for (int i = 0; i < kPeriods; ++i) {
    const auto record = next(source);
    if (!record) continue;
    ++records;
    newest = record->rdt_sequence;
  }
  EXPECT_NEAR(static_cast<double>(records) / kPeriods, 0.75, 0.0154);
  EXPECT_GT(newest, 19'900u) << "lost records leave gaps in the count";
}

TEST(FtSource, DoesNotAllocate) {
  FtSource source(FtSourceOptions{});
  test::NoAllocation guard("a sensor period");
  ask(source, RdtCommand::kStream);
  source.tick();
}

TEST(FtSource, ReadsInStepsOfTheResolution) {
  FtSourceOptions options = quiet();
  options.step_n = 0.03;
  options.step_n_m = 0.001;
  FtSource source(options);
  ask(source, RdtCommand::kStream);
  source.set_wrench(wrench(1.0, 0.0104));
  const auto record = next(source);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->counts[0], 990'000);
  EXPECT_EQ(record->counts[5], 10'000);
}

// Mean square of the zero, and of its change in a second, over 20000 s at one record a second.
TEST(FtSource, ItsZeroWandersAsFarAndAsFastAsIsAsked) {
  FtSourceOptions options = quiet();
  options.period = kSecond;
  options.drift_n = 1.5;
  options.drift_n_per_s = 0.3;
  FtSource source(options);
  ask(source, RdtCommand::kStream);
  double squares = 0.0, changes = 0.0, last = 0.0, torque = 0.0;
  constexpr int kRecords = 20'000;
  for (int i = 0; i < kRecords; ++i) {
    const auto record = next(source);
    ASSERT_TRUE(record);
    const double zero = 1e-6 * record->counts[1];
    squares += zero * zero;
    changes += (zero - last) * (zero - last);
    torque += std::abs(record->counts[3]);
    last = zero;
  }
  EXPECT_NEAR(std::sqrt(squares / kRecords), 1.5, 0.2);
  EXPECT_NEAR(std::sqrt(changes / kRecords), 0.3, 0.01);
  EXPECT_EQ(torque, 0.0);
}

TEST(FtSource, ABiasTakesTheDriftAsZeroToo) {
  FtSourceOptions options = quiet();
  options.drift_n = 1.5;
  options.drift_n_per_s = 1.0;
  FtSource source(options);
  for (int i = 0; i < 1000; ++i) next(source);
  ask(source, RdtCommand::kBias);
  ask(source, RdtCommand::kStream);
  const auto record = next(source);
  ASSERT_TRUE(record);
  EXPECT_LT(std::abs(1e-6 * record->counts[0]), 0.2) << "a millisecond's drift is 0.03 N";
}

TEST(FtSource, ZerosThatDoNotWanderStayUntilTheBias) {
  FtSourceOptions options = quiet();
  options.zero = {{1.5, -2.0, 0.7}, {0.05, -0.02, 0.01}};
  FtSource source(options);
  ask(source, RdtCommand::kStream);
  const std::array<std::int32_t, 6> zeros = {1'500'000, -2'000'000, 700'000,
                                             50'000,    -20'000,    10'000};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(next(source)->counts, zeros);
  ask(source, RdtCommand::kBias);
  EXPECT_EQ(next(source)->counts, (std::array<std::int32_t, 6>{}));
}

}  // namespace
}  // namespace handrail
