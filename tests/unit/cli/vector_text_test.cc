#include "client/cli/vector_text.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(VectorText, ReadsThreeNumbers) {
  EXPECT_EQ(*parse_vector("--at", "350,0,429", "mm", ""), Vec3(350, 0, 429));
  EXPECT_EQ(*parse_vector("--at", "-1, +2.5 ,3e1", "mm", ""), Vec3(-1, 2.5, 30));
}

TEST(VectorText, SaysWhatItExpectedForAnythingElse) {
  EXPECT_EQ(parse_vector("--at", "100mm,0,0", "mm", "350,0,429").message(),
            "--at: '100mm,0,0': expected three numbers in mm, such as 350,0,429");
  for (const char* bad : {"", ",", "1,2", "1,2,3,4", "1,2,", "1,,3", "a,b,c", "1,2,3x", "nan,0,0",
                          "inf,0,0", "1e999,0,0", "1;2;3", "+-1,2,3", "++1,2,3", "x"}) {
    EXPECT_FALSE(parse_vector("--at", bad, "mm", "").is_ok()) << bad;
  }
}

TEST(VectorText, ReadsAxesWithAndWithoutSign) {
  EXPECT_EQ(*parse_direction("--dir", "x"), Vec3(1, 0, 0));
  EXPECT_EQ(*parse_direction("--dir", "+y"), Vec3(0, 1, 0));
  EXPECT_EQ(*parse_direction("--dir", "-z"), Vec3(0, 0, -1));
  EXPECT_EQ(*parse_direction("--dir", "0,-3,0.5"), Vec3(0, -3, 0.5));
}

TEST(VectorText, RefusesADirectionThatIsNone) {
  EXPECT_EQ(parse_direction("--dir", "0,0,0").message(),
            "--dir: '0,0,0': expected a direction with a length");
  for (const char* bad : {"", "+", "-", "w", "a", "xx", "--x", "-xy", "X", "1,2"}) {
    EXPECT_FALSE(parse_direction("--dir", bad).is_ok()) << bad;
  }
}

TEST(VectorText, KeepsANumberWithinItsRange) {
  EXPECT_EQ(*parse_number("--stiffness", "10", 0, 10, "N/mm"), 10.0);
  EXPECT_EQ(parse_number("--stiffness", "10.1", 0, 10, "N/mm").message(),
            "--stiffness: '10.1': expected a number from 0 to 10 N/mm");
  EXPECT_FALSE(parse_number("--stiffness", "-0.1", 0, 10, "N/mm").is_ok());
  EXPECT_FALSE(parse_number("--stiffness", "nan", 0, 10, "N/mm").is_ok());
  EXPECT_FALSE(parse_number("--stiffness", "1N", 0, 10, "N/mm").is_ok());
}

}  // namespace
}  // namespace handrail
