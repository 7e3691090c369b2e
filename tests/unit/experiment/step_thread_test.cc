#include "client/experiment/screw/step_thread.h"

#include <gtest/gtest.h>

#include <vector>

namespace handrail {
namespace {

TEST(StepThread, RunsOnlyWhileItIsLetGoOn) {
  std::vector<int> seen;
  StepThread thread([&](StepThread& self) {
    for (int i = 0; i < 3; ++i) {
      seen.push_back(i);
      if (!self.pause()) return;
    }
    seen.push_back(99);
  });
  EXPECT_TRUE(seen.empty());
  for (int i = 0; i < 3; ++i) {
    thread.resume();
    ASSERT_EQ(seen.size(), static_cast<std::size_t>(i) + 1);
    EXPECT_EQ(seen.back(), i);
  }
  thread.resume();
  EXPECT_EQ(seen.back(), 99);
  thread.resume();
  EXPECT_EQ(seen.size(), 4u) << "it has ended";
}

TEST(StepThread, OneThatPausesIsToldToEnd) {
  bool told = false, began = false;
  {
    StepThread thread([&](StepThread& self) { told = !self.pause() && !self.pause(); });
    thread.resume();
    EXPECT_FALSE(told);
  }
  EXPECT_TRUE(told);
  {
    StepThread never([&](StepThread&) { began = true; });
  }
  EXPECT_FALSE(began);
}

}  // namespace
}  // namespace handrail
