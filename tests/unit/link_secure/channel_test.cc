#include <gtest/gtest.h>

#include "tests/support/made_up_net/made_up_net.h"

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

// proto/WIRE.md says these sizes.
TEST(DtlsChannel, ACookieIsSmallerThanAnyHelloThatAsksForIt) {
  SecurePair pair;
  ASSERT_TRUE(pair.connect());
  ASSERT_GE(pair.net.sent.size(), 2u);
  EXPECT_EQ(pair.net.sent[1].bytes.size(), 44u);
  EXPECT_GT(pair.net.sent[0].bytes.size(), 44u);
  for (const auto& datagram : pair.net.sent) EXPECT_LE(datagram.bytes.size(), 1232u);
}

}  // namespace
}  // namespace handrail
