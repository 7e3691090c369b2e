#include "server/model/reason.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "server/model/link_state.h"

namespace handrail {
namespace {

TEST(Reason, DescribesEveryCodeInItsOwnWords) {
  std::set<std::string> seen;
  for (int i = 0; i < static_cast<int>(Reason::kCount); ++i) {
    const char* const text = describe(static_cast<Reason>(i));
    ASSERT_NE(text, nullptr) << "code " << i;
    EXPECT_STRNE(text, "") << "code " << i;
    EXPECT_EQ(std::string(text).find("unknown"), std::string::npos) << "code " << i;
    EXPECT_TRUE(seen.insert(text).second) << "code " << i << " repeats: " << text;
  }
}

TEST(Reason, AdmitsThatACodeFromElsewhereIsUnknown) {
  EXPECT_STREQ(describe(static_cast<Reason>(250)), "unknown reason");
  EXPECT_STREQ(describe(Reason::kCount), "unknown reason");
}

TEST(SessionState, NamesEveryStateAndDesireApart) {
  std::set<std::string> states, desires;
  for (int i = 0; i < static_cast<int>(SessionState::kCount); ++i) {
    states.insert(name_of(static_cast<SessionState>(i)));
  }
  for (int i = 0; i < static_cast<int>(Desired::kCount); ++i) {
    desires.insert(name_of(static_cast<Desired>(i)));
  }
  EXPECT_EQ(states.size(), static_cast<std::size_t>(SessionState::kCount));
  EXPECT_EQ(desires.size(), static_cast<std::size_t>(Desired::kCount));
  EXPECT_EQ(states.count("unknown") + desires.count("unknown"), 0u);
}

}  // namespace
}  // namespace handrail
