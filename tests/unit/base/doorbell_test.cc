#include "server/base/doorbell.h"

#include <gtest/gtest.h>
#include <poll.h>

#include "tests/support/no_allocation.h"

namespace handrail {
namespace {

bool readable(const Doorbell& bell) {
  pollfd wanted{bell.fd(), POLLIN, 0};
  return ::poll(&wanted, 1, 0) == 1;
}

TEST(Doorbell, SeveralRingsAreAnsweredOnce) {
  const Doorbell bell;
  EXPECT_FALSE(readable(bell));
  EXPECT_FALSE(bell.answer());
  for (int i = 0; i < 3; ++i) bell.ring();
  EXPECT_TRUE(readable(bell));
  EXPECT_TRUE(bell.answer());
  EXPECT_FALSE(readable(bell));
  EXPECT_FALSE(bell.answer());
}

TEST(Doorbell, NeverTouchesTheHeap) {
  const Doorbell bell;
  const test::NoAllocation guard("doorbell");
  bell.ring();
  (void)bell.answer();
}

}  // namespace
}  // namespace handrail
