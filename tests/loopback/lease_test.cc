// Two operators at the real programs: one drives, the other is told, asks and takes over.
#include <gmock/gmock.h>

#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class TwoOperators : public WholeCell {
 protected:
  std::pair<int, std::string> by(const std::string& who, std::vector<std::string> words) {
    words.insert(words.end(), {"--as", who});
    return handrail(std::move(words));
  }
  // A link that a busy machine disturbed is waited for, as in order().
  bool engages(const std::string& who) {
    return within(kPatience, [&] { return by(who, {"engage"}).first == 0; });
  }
};

TEST_F(TwoOperators, ExactlyOneDrivesAndTheOtherIsToldAndTakesOver) {
  ASSERT_TRUE(engages("anna"));
  for (const char* order : {"engage", "disengage", "reset"}) {
    const auto [code, said] = by("ben", {order});
    EXPECT_EQ(code, 1) << order;
    EXPECT_THAT(said, AllOf(HasSubstr("refused: anna has the lease for "),
                            HasSubstr("'handrail lease take' asks for it")));
  }
  EXPECT_EQ(status().state(), "engaged");
  EXPECT_THAT(by("ben", {"lease", "show"}).second, HasSubstr("lease: anna has it for "));

  // Ben waits for the answer while Anna grants.
  Program asks(folder, "handrail", {"lease", "take", "--as", "ben", "--socket", socket()});
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.lease().asked_by() == "ben"; }));
  EXPECT_EQ(by("ben", {"lease", "grant"}).first, 1) << "not his to give";
  EXPECT_EQ(by("anna", {"lease", "grant"}).first, 0);
  EXPECT_EQ(asks.finish(), 0);
  EXPECT_TRUE(reaches("off")) << "the new driver must engage";
  EXPECT_EQ(by("anna", {"clutch", "on"}).first, 1);
  EXPECT_TRUE(engages("ben"));
  EXPECT_TRUE(reaches("engaged"));

  EXPECT_EQ(by("anna", {"stop"}).first, 0) << "stop is anybody's";
  EXPECT_EQ(by("anna", {"reset"}).first, 1);
  EXPECT_EQ(by("ben", {"reset"}).first, 0);
  EXPECT_EQ(by("ben", {"lease", "release"}).first, 0);
  EXPECT_THAT(by("anna", {"lease", "show", "--json"}).second, HasSubstr("\"holder\": \"\""));
  for (const char* line : {"anna has the lease by engaging", "ben asks anna for the lease",
                           "ben has the lease, granted by anna", "ben releases the lease"}) {
    EXPECT_THAT(master->output(), HasSubstr(line));
  }
}

TEST_F(TwoOperators, WhoEndsTheProgramThatAsksWithdrawsTheQuestion) {
  ASSERT_EQ(by("anna", {"lease", "take"}).first, 0);
  const auto asks = [](const pb::Status& s) { return s.lease().asked_by() == "ben"; };
  Program ben(folder, "handrail", {"lease", "take", "--as", "ben", "--socket", socket()});
  ASSERT_TRUE(eventually(asks));
  ben.send(SIGINT);
  EXPECT_TRUE(eventually([&](const pb::Status& s) { return !asks(s); }));
  EXPECT_EQ(status().lease().holder(), "anna");
}

}  // namespace
}  // namespace handrail
