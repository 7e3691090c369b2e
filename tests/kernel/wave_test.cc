// The judge of comedi_test's waveforms: what is right passes, and nothing else.
#include "tests/kernel/wave.h"

#include <gtest/gtest.h>

namespace handrail::kernel {
namespace {

// Readings a millisecond apart, input 1 after 83 us, from `us` on; `lost` of them are left out
// after the tenth.
int wrong_of(std::uint64_t us, std::uint64_t lost, double volts_more = 0.0, bool flipped = false) {
  WaveWatch watch;
  int wrong = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    const std::uint64_t at = us + 1000 * (i + (i > 10 ? lost : 0));
    const unsigned int other = square((at + 83) % 100'000);
    const double saw = wave_volts(sawtooth(at % 100'000)) + volts_more;
    const double rect = wave_volts(flipped ? 2 * kWaveMiddle - other : other);
    wrong += watch.next(saw, rect, 1000.0, 83.0) ? 0 : 1;
  }
  return wrong;
}

TEST(WaveWatch, PassesTheWavesThemselvesFromAnyBeginning) {
  for (std::uint64_t us = 0; us < 100'000; us += 777) ASSERT_EQ(wrong_of(us, 0), 0) << us;
}

TEST(WaveWatch, SeesOneLostReading) {
  EXPECT_EQ(wrong_of(5, 1), 1);
  EXPECT_EQ(wrong_of(5, 50), 1);
}

TEST(WaveWatch, SeesAnotherScaleAndAnotherSign) {
  EXPECT_GT(wrong_of(5, 0, 0.02), 5);
  EXPECT_GT(wrong_of(5, 0, 0.0, true), 400);
}

// The other input is as it should be: the sawtooth alone says so.
TEST(WaveWatch, SeesVoltsThatNoWaveHas) {
  const double low = wave_volts(square(0));
  const double under = wave_volts(kWaveMiddle - kWaveAmplitude - 30);
  const double over = wave_volts(kWaveMiddle + kWaveAmplitude + 30);
  EXPECT_FALSE(WaveWatch().next(under, low, 0.0, 83.0));
  EXPECT_FALSE(WaveWatch().next(over, low, 0.0, 83.0));
  WaveWatch watch;
  EXPECT_FALSE(watch.next(under, low, 0.0, 83.0));
  EXPECT_FALSE(watch.next(under, low, 0.0, 83.0)) << "nor where it stays so";
  EXPECT_FALSE(watch.next(wave_volts(sawtooth(5000)), low, 0.0, 83.0)) << "nor where it leaps back";
  EXPECT_TRUE(watch.next(wave_volts(sawtooth(6000)), low, 1000.0, 83.0));
}

TEST(WaveWatch, SeesACountMoreAtTheOtherInput) {
  const double saw = wave_volts(sawtooth(5000));
  EXPECT_TRUE(WaveWatch().next(saw, wave_volts(square(5000)), 0.0, 83.0));
  EXPECT_FALSE(WaveWatch().next(saw, wave_volts(square(5000) + 1), 0.0, 83.0));
  EXPECT_FALSE(WaveWatch().next(saw, wave_volts(square(5000) - 1), 0.0, 83.0));
}

// A count of the sawtooth lasts 15.3 us: two readings are that much from the truth at most.
TEST(WaveWatch, ForgivesTheRoundingOfTwoReadingsAndNoMore) {
  const auto follows = [](std::uint64_t from, double by) {
    WaveWatch watch;
    const auto read = [&](std::uint64_t us, double since) {
      return watch.next(wave_volts(sawtooth(us)), wave_volts(square(us)), since, 83.0);
    };
    return read(from, 0.0) && read(from + 1000, 1000.0 + by);
  };
  for (std::uint64_t us = 1000; us < 40'000; us += 7) {
    for (const double by : {-16.0, 0.0, 16.0}) ASSERT_TRUE(follows(us, by)) << us << " " << by;
    for (const double by : {-48.0, 48.0}) ASSERT_FALSE(follows(us, by)) << us << " " << by;
  }
}

TEST(Wave, ThePhaseOfASawtoothIsWhenItWasToHalfACount) {
  for (std::uint64_t us = 0; us < 100'000; us += 7) {
    ASSERT_NEAR(wave_phase(wave_volts(sawtooth(us))), static_cast<double>(us), 7.7) << us;
  }
}

TEST(Wave, IsWhatItsSourceSays) {
  // A 20th of 65535 is 3276; half of 65535 is 32767.
  EXPECT_EQ(sawtooth(0), 29491u);
  EXPECT_EQ(sawtooth(50'000), 32767u);
  EXPECT_EQ(sawtooth(99'999), 36042u);
  EXPECT_EQ(square(49'999), 29491u);
  EXPECT_EQ(square(50'000), 36043u);
  EXPECT_NEAR(wave_volts(36043), 0.99962, 1e-5);
}

}  // namespace
}  // namespace handrail::kernel
