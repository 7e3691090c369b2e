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
