#include "devices/hand/recorded_hand_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "server/base/units.h"

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Result<RecordedMotion> read(const std::string& text) {
  std::istringstream in(text);
  return read_recorded_motion(in, "hand.csv");
}

std::string error_of(const std::string& text) {
  const auto motion = read(text);
  EXPECT_FALSE(motion.is_ok()) << text;
  return motion.message();
}

const std::string kHeader = "t_s,x_mm,y_mm\n";

TEST(RecordedHandIo, ReadsMillimetresIntoMetres) {
  const auto motion = read(kHeader + "5.0,10,-4\n5.1,20.5,4\n5.2,1e1,+0\n");
  ASSERT_TRUE(motion.is_ok()) << motion.message();
  EXPECT_EQ(motion->rows(), 3u);
  EXPECT_NEAR(motion->duration(), 0.2, 1e-12);
  EXPECT_LT((motion->half_extent() - kMm * Vec3(5.25, 4.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((motion->at(0.1) - kMm * Vec3(5.25, 4.0, 0.0)).norm(), 1e-9);
}

TEST(RecordedHandIo, ReadsAThirdAxis) {
  const auto motion = read("t_s,x_mm,y_mm,z_mm\n0,0,0,0\n0.1,0,0,6\n");
  ASSERT_TRUE(motion.is_ok()) << motion.message();
  EXPECT_NEAR(motion->at(1.0).z(), 3.0 * kMm, 1e-12);
}

TEST(RecordedHandIo, AcceptsWindowsLineEndsBlanksAndEmptyLinesAtTheEnd) {
  const auto motion = read("\xEF\xBB\xBFt_s, x_mm, y_mm\r\n0, 1, 2\r\n0.1,\t1,3 \r\n\r\n\n  \n");
  ASSERT_TRUE(motion.is_ok()) << motion.message();
  EXPECT_EQ(motion->rows(), 2u);
  EXPECT_EQ(read(kHeader + "0,1,2\n1,1,3")->rows(), 2u);
}

TEST(RecordedHandIo, TextWhereANumberShouldBeNamesLineColumnAndValue) {
  EXPECT_THAT(error_of(kHeader + "0,1,2\n0.1,abc,3\n"),
              AllOf(StartsWith("hand.csv:3: "), HasSubstr("x_mm"), HasSubstr("\"abc\""),
                    HasSubstr("expected a number")));
  EXPECT_THAT(error_of(kHeader + "0,1,2mm\n"), AllOf(StartsWith("hand.csv:2: "), HasSubstr("2mm")));
  EXPECT_THAT(error_of(kHeader + "0,1,\n"), AllOf(StartsWith("hand.csv:2: "), HasSubstr("y_mm")));
  EXPECT_THAT(error_of(kHeader + "0,1,+-2\n"), HasSubstr("\"+-2\""));
}

TEST(RecordedHandIo, RefusesNumbersThatAreNotFiniteOrOutOfRange) {
  for (const char* bad : {"nan", "NaN", "inf", "-inf", "1e999", "100001", "-1e300"}) {
    EXPECT_THAT(error_of(kHeader + "0,1,2\n1,1,2\n2," + bad + ",2\n"),
                AllOf(StartsWith("hand.csv:4: "), HasSubstr(bad)));
  }
  EXPECT_THAT(error_of(kHeader + "0,1,2\nnan,1,2\n"),
              AllOf(StartsWith("hand.csv:3: "), HasSubstr("t_s")));
}

TEST(RecordedHandIo, RefusesBackwardAndEqualTimes) {
  EXPECT_THAT(
      error_of(kHeader + "0.5,1,2\n0.4,1,2\n"),
      AllOf(StartsWith("hand.csv:3: "), HasSubstr("\"0.4\""), HasSubstr("more than the 0.5")));
  EXPECT_THAT(error_of(kHeader + "0,1,2\n0.4,1,2\n0.4,1,3\n"), StartsWith("hand.csv:4: "));
  EXPECT_TRUE(read(kHeader + "1700000000.000000,1,2\n1700000000.000001,1,3\n").is_ok());
}

// What lies between two rows is simulated.
TEST(RecordedHandIo, RefusesAGapThatNoRecorderLeaves) {
  EXPECT_THAT(error_of(kHeader + "0,1,2\n1,1,2\n31557600,1,2\n"),
              AllOf(StartsWith("hand.csv:4: "), HasSubstr("\"31557600\""),
                    HasSubstr("expected at most 60 s more than the 1 of the row before")));
  EXPECT_TRUE(read(kHeader + "0,1,2\n60,1,2\n").is_ok());
}

TEST(RecordedHandIo, RefusesAWrongNumberOfColumns) {
  EXPECT_THAT(error_of(kHeader + "0,1,2\n1,1\n"),
              AllOf(StartsWith("hand.csv:3: "), HasSubstr("2 columns"), HasSubstr("expected 3")));
  EXPECT_THAT(error_of(kHeader + "0,1,2,3,4,5\n"),
              AllOf(StartsWith("hand.csv:2: "), HasSubstr("6 columns")));
}

TEST(RecordedHandIo, RefusesFilesWithoutHeaderOrRows) {
  EXPECT_THAT(error_of(""), AllOf(StartsWith("hand.csv:1: "), HasSubstr("empty")));
  EXPECT_THAT(error_of("0,1,2\n1,1,2\n"), AllOf(StartsWith("hand.csv:1: "), HasSubstr("header")));
  EXPECT_THAT(error_of("t_s,y_mm,x_mm\n1,1,2\n"), StartsWith("hand.csv:1: "));
  EXPECT_THAT(error_of("t_s,x_mm,y_mm,z_mm,w_mm\n"), StartsWith("hand.csv:1: "));
  EXPECT_THAT(error_of(kHeader), AllOf(HasSubstr("0 rows"), HasSubstr("at least 2")));
  EXPECT_THAT(error_of(kHeader + "0,1,2\n"), HasSubstr("1 rows"));
}

TEST(RecordedHandIo, RefusesAnEmptyLineBetweenRows) {
  EXPECT_THAT(error_of(kHeader + "0,1,2\n\n\n1,1,2\n"),
              AllOf(StartsWith("hand.csv:3: "), HasSubstr("empty")));
}

TEST(RecordedHandIo, RefusesALineWithoutEndInsteadOfReadingItAll) {
  EXPECT_THAT(error_of(kHeader + "0,1,2\n" + std::string(100'000, '7')),
              AllOf(StartsWith("hand.csv:3: "), HasSubstr("longer than")));
  EXPECT_THAT(error_of(std::string(5000, '\0')), StartsWith("hand.csv:1: "));
  EXPECT_LT(error_of(kHeader + "0,1," + std::string(900, 'x') + "\n").size(), 200u);
}

TEST(RecordedHandIo, NamesAFileItCannotOpenOrRead) {
  EXPECT_THAT(load_recorded_motion("/nowhere/hand.csv").message(),
              AllOf(HasSubstr("/nowhere/hand.csv"), HasSubstr("No such file")));
  EXPECT_THAT(load_recorded_motion("/").message(), AllOf(StartsWith("/"), HasSubstr("read")));
}

TEST(RecordedHandIo, LoadsALongFileOfAnyRate) {
  const std::string path = ::testing::TempDir() + "long_hand.csv";
  {
    std::ofstream out(path);
    out << "t_s,x_mm,y_mm\n";
    for (int i = 0; i < 200'000; ++i) out << 0.0005 * i << ',' << i % 97 << ',' << i % 89 << '\n';
  }
  const auto motion = load_recorded_motion(path);
  std::remove(path.c_str());
  ASSERT_TRUE(motion.is_ok()) << motion.message();
  EXPECT_EQ(motion->rows(), 200'000u);
  EXPECT_EQ(motion->gaps(), 0u);
}

}  // namespace
}  // namespace handrail
