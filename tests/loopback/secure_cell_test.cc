// Slave and master over the encrypted link, with keys as their users make them.
#include <gtest/gtest.h>

#include <csignal>

#include "tests/loopback/secure_cell.h"

namespace handrail {
namespace {

TEST_F(SecureCell, TheHandDrivesTheArmAndTheStatusSaysWhoIsThere) {
  ASSERT_TRUE(connected());
  order("engage: true");
  const Vec3 before = mm(at_rest().tip());
  EXPECT_GT((mm(move_hand("10, 0, 0").tip()) - before).norm(), 10.0);
  const pb::PeerStatus peer = status().peer();
  EXPECT_TRUE(peer.encrypted());
  EXPECT_EQ(peer.name(), "cell");
  EXPECT_EQ(peer.key(), key_id(at_slave.load()->key.public_key()));
  EXPECT_EQ(peer.address(), "127.0.0.1:" + std::to_string(link_port));
  EXPECT_TRUE(slave->after("encrypted session with desk, key ")
                  .starts_with(key_id(at_master.load()->key.public_key())));
}

// As one line after the other is typed, or read from a file.
TEST_F(SecureCell, AnEngageRightAfterTheStartWaitsForTheSession) {
  order("engage: true");
  EXPECT_TRUE(slave_reaches("engaged"));
}

TEST_F(SecureCell, AKeyThatIsRemovedStopsTheArmAndIsNotLetInAgainUntilItIsTrusted) {
  ASSERT_TRUE(connected());
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  const TrustList masters = *at_slave.trusted();
  ASSERT_TRUE(at_slave.save(TrustList(), "a test"));
  EXPECT_TRUE(eventually([](const pb::Status& s) { return !s.peer().problem().empty(); }));
  EXPECT_NE(slave->after("session fault: "), "");
  EXPECT_NE(status().peer().problem().find("does not trust our key"), std::string::npos);
  EXPECT_NE(status().peer().problem().find("handrail keys trust desk master p256:"),
            std::string::npos);
  ASSERT_TRUE(at_slave.save(masters, "a test"));
  EXPECT_TRUE(connected());
  EXPECT_TRUE(slave_reaches("fault"));
}

TEST_F(SecureCell, ASlaveThatWasKilledAndStartedAgainIsFound) {
  ASSERT_TRUE(connected());
  slave->kill();
  launch_secure_slave();
  EXPECT_NE(slave->after("encrypted session with desk"), "");
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() < 100.0; }));
}

TEST_F(SecureCell, AMasterThatWasPausedForThreeSecondsGoesOnWithItsSession) {
  ASSERT_TRUE(connected());
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  master->send(SIGSTOP);
  EXPECT_NE(slave->after("session fault: link lost"), "");
  sleep_until(monotonic_now() + 3 * kSecond);
  master->send(SIGCONT);
  EXPECT_TRUE(connected());
  EXPECT_TRUE(eventually(
      [](const pb::Status& s) { return s.slave_state() == "fault" && s.packet_age_ms() < 100.0; }));
}

TEST_F(SecureCell, AMasterWithoutItsKeyDoesNotStartAndNeverSpeaksPlain) {
  master->send(SIGTERM);
  (void)master->finish();
  const auto without =
      launch_with(folder.path() + "/nothing", "handrail-master",
                  "operator_socket: '" + socket() + "'", "localhost:" + std::to_string(link_port));
  EXPECT_EQ(without->finish(), 2);
  EXPECT_NE(without->output().find("the encrypted link needs a key: no key at " + folder.path() +
                                   "/nothing/key: `handrail keys new` makes one"),
            std::string::npos)
      << without->output();
}

TEST_F(SecureCell, ANameThatResolvesToNothingIsSaid) {
  master->send(SIGTERM);
  (void)master->finish();
  master = launch_with(master_keys, "handrail-master", "operator_socket: '" + socket() + "'",
                       "no-such-host.invalid");
  EXPECT_NE(master->after("'no-such-host.invalid' has no address: "), "");
  const std::string why = refusal("engage: true");
  EXPECT_NE(why.find("has no address"), std::string::npos) << why;
}

}  // namespace
}  // namespace handrail
