// One fast row, end to end: namespaces, an encrypted link through the emulator, the judges.
#include <gmock/gmock.h>

#include "tests/emulator/netfault_bench.h"

namespace handrail::emulator {
namespace {

using ::testing::HasSubstr;

class FaultRow : public NetfaultTest {
 protected:
  std::string row(const std::vector<std::string>& words, int code) {
    Program faults(folder_, "handrail-faults", words);
    EXPECT_EQ(faults.finish(), code) << faults.output();
    return faults.output();
  }
};

TEST_F(FaultRow, AMasterWhoseClockIsFarAheadIsNotNoticed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "stops are judged to the millisecond: programs with checks put in are too slow";
#endif
  const std::string said = row({"C2", "--seed", "3", "--results", folder_.path()}, 0);
  EXPECT_THAT(said, ::testing::AnyOf(HasSubstr("C2   PASS"), HasSubstr("C2   SKIPPED")));
  EXPECT_THAT(said, HasSubstr("seed 3"));
}

TEST_F(FaultRow, WrongWordsAreUsage) {
  EXPECT_THAT(row({"N99"}, 2), HasSubstr("expected an option, or a row"));
}

}  // namespace
}  // namespace handrail::emulator
