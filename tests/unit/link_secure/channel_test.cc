#include <gtest/gtest.h>

#include "tests/unit/link_secure/made_up_net.h"

namespace handrail {
namespace {

using test::Bytes;
using test::SecurePair;
using State = DtlsChannel::State;

TEST(DtlsChannel, IsClosedInOrderWhenItGoes) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_TRUE(pair.say(Bytes(10, 1)));
  pair.master.set_addresses({});
  pair.master.set_trusted(TrustList());
  pair.step();
  EXPECT_EQ(pair.slave.leader(), nullptr);
  EXPECT_EQ(pair.slave.counts().failed, 0u);
}

}  // namespace
}  // namespace handrail
