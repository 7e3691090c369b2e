// Slave and master over the encrypted link, with keys as their users make them.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <sstream>

#include "tests/loopback/secure_cell.h"

namespace handrail {
namespace {

// With what a change of keys needs.
class ChangedKeys : public SecureCell {
 protected:
  // `handrail keys ...` of one side's user: its exit code.
  int keys_order(const std::string& keys, std::vector<std::string> words) {
    ::setenv("HANDRAIL_KEYS", keys.c_str(), 1);
    words.insert(words.begin(), "keys");
    Program program(folder, "handrail", words);
    const int code = program.finish();
    said = program.output();
    return code;
  }
  // Types at one side what the other side's `keys show` prints.
  int trust_at(const std::string& keys, const std::string& of) {
    EXPECT_EQ(keys_order(of, {"show"}), 0);
    std::istringstream line(said.substr(said.find("handrail keys trust ") + 14));
    std::vector<std::string> words;
    for (std::string word; words.size() < 5 && line >> word;) words.push_back(word);
    return keys_order(keys, words);
  }
  // Waits until `old` is retired: the key that took its place.
  static PublicKey settled(const KeyFolder& keys, const PublicKey& old) {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    while (keys.load()->key.public_key() == old && monotonic_now() < give_up) {
      sleep_until(monotonic_now() + 20 * kMillisecond);
    }
    EXPECT_FALSE(keys.load()->next);
    return keys.load()->key.public_key();
  }
  static std::optional<Trusted> trusted_when_settled(const KeyFolder& keys, const char* name) {
    const Nanos give_up = monotonic_now() + Program::kPatience;
    while (keys.trusted()->find(name)->next && monotonic_now() < give_up) {
      sleep_until(monotonic_now() + 20 * kMillisecond);
    }
    return *keys.trusted()->find(name);
  }

  std::string said;  // by the last keys_order()
};

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

TEST_F(ChangedKeys, EachSidesKeyIsChangedWhileTheArmFollowsAndTheOldOnesEnd) {
  ASSERT_TRUE(connected());
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  const PublicKey old_cell = at_slave.load()->key.public_key();
  const PublicKey old_desk = at_master.load()->key.public_key();

  ASSERT_EQ(keys_order(slave_keys, {"new", "slave"}), 0);
  ASSERT_EQ(trust_at(master_keys, slave_keys), 0);
  const PublicKey new_cell = settled(at_slave, old_cell);
  EXPECT_EQ(*trusted_when_settled(at_master, "cell"), (Trusted{"cell", Role::kSlave, new_cell}));
  EXPECT_TRUE(eventually([&](const pb::Status& s) { return s.peer().key() == key_id(new_cell); }));

  ASSERT_EQ(keys_order(master_keys, {"new", "master"}), 0);
  // Not known yet: tried, refused and said at the slave; the old one serves.
  EXPECT_NE(slave->after("shows key " + key_id(*at_master.load()->entry().next) +
                         ", which is not trusted here"),
            "");
  ASSERT_EQ(trust_at(slave_keys, master_keys), 0);
  const PublicKey new_desk = settled(at_master, old_desk);
  EXPECT_EQ(*trusted_when_settled(at_slave, "desk"), (Trusted{"desk", Role::kMaster, new_desk}));

  EXPECT_EQ(status().state(), "engaged");
  EXPECT_EQ(status().slave_state(), "engaged");
  const Vec3 before = mm(at_rest().tip());
  EXPECT_GT((mm(move_hand("10, 0, 0").tip()) - before).norm(), 10.0);
}

TEST_F(ChangedKeys, ALostKeyIsMadeAnewAtTheMachineAndSaid) {
  ASSERT_TRUE(connected());
  std::filesystem::remove(at_slave.key_path());
  (void)slave->after("; the key read before stays in use");
  ASSERT_EQ(keys_order(slave_keys, {"new", "slave", "--as", "cell"}), 0);
  EXPECT_EQ(slave->after("keys: ours is "), key_id(at_slave.load()->key.public_key()));
  // Whoever made it, the master has another one pinned, and says what to do.
  EXPECT_NE(trust_at(master_keys, slave_keys), 0);
  ASSERT_EQ(keys_order(master_keys, {"remove", "cell"}), 0);
  ASSERT_EQ(trust_at(master_keys, slave_keys), 0);
  EXPECT_TRUE(eventually([&](const pb::Status& s) {
    return s.peer().key() == key_id(at_slave.load()->key.public_key());
  }));
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

TEST_F(SecureCell, AnOperatorElsewhereDrivesWithAKeyAndLosesTheArmWithIt) {
  const std::string anna_keys = folder.path() + "/anna-keys";
  KeyFolder anna(anna_keys);
  TrustList of_master = *at_master.trusted(), of_anna;
  ASSERT_TRUE(of_master.add(anna.create("anna", Role::kOperator)->entry()));
  ASSERT_TRUE(of_anna.add(at_master.load()->entry()));
  ASSERT_TRUE(at_master.save(of_master, "a test") && anna.save(of_anna, "a test"));
  master->send(SIGTERM);
  (void)master->finish();
  launch_secure_master("operator_address: '127.0.0.1' operator_port: 0 ");
  const int port = master->number_after("operators=127.0.0.1:");
  ASSERT_TRUE(connected());
  ::setenv("HANDRAIL_KEYS", anna_keys.c_str(), 1);
  const std::vector<std::string> engage = {"engage", "--hold", "--master",
                                           "localhost:" + std::to_string(port)};
  Program first(folder, "handrail", engage);
  ASSERT_TRUE(slave_reaches("engaged"));
  EXPECT_EQ(status().lease().holder(), "anna@" + key_id(anna.load()->key.public_key()));
  first.kill();
  EXPECT_TRUE(slave_reaches("off")) << "nobody is there any more";

  Program second(folder, "handrail", engage);
  ASSERT_TRUE(slave_reaches("engaged"));
  ASSERT_TRUE(of_master.remove("anna") && at_master.save(of_master, "a test"));
  EXPECT_TRUE(slave_reaches("off")) << "the key is not let in any more";
  EXPECT_NE(second.finish(), 0);
}

}  // namespace
}  // namespace handrail
