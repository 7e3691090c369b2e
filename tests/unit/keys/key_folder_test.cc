#include "server/keys/key_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

mode_t mode_of(const std::string& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) == 0 ? info.st_mode & 07777 : 0;
}

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

class KeyFolderTest : public ::testing::Test {
 protected:
  TempFolder folder_;
  KeyFolder keys_{folder_.path() + "/a/handrail"};
  PublicKey key() const { return OwnKey::generate()->public_key(); }
};

TEST_F(KeyFolderTest, AKeyIsMadeOnceAndOnlyItsOwnerReadsIt) {
  const auto made = keys_.create("cell", Role::kSlave);
  ASSERT_TRUE(made) << made.message();
  EXPECT_EQ(mode_of(keys_.key_path()), 0600u);
  EXPECT_EQ(mode_of(folder_.path() + "/a/handrail"), 0700u);
  const auto read = keys_.load();
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(read->key.public_key(), made->key.public_key());
  const auto again = keys_.create("cell", Role::kSlave);
  ASSERT_FALSE(again);
  EXPECT_NE(again.message().find("there is a key already"), std::string::npos);
  EXPECT_EQ(keys_.load()->key.public_key(), made->key.public_key());
}

TEST_F(KeyFolderTest, WhatWasChangedIsRemembered) {
  ASSERT_TRUE(keys_.create("cell", Role::kSlave));
  ASSERT_TRUE(keys_.save(TrustList(), "removed desk"));
  std::ifstream file(keys_.history_path());
  std::string first, second;
  std::getline(file, first);
  std::getline(file, second);
  EXPECT_NE(first.find("made key " + key_id(keys_.load()->key.public_key()) + " of cell"),
            std::string::npos);
  EXPECT_NE(second.find(": removed desk"), std::string::npos) << second;
}

TEST_F(KeyFolderTest, NameAndRolesComeBack) {
  Roles roles = Role::kMaster;
  roles.add(Role::kOperator);
  ASSERT_TRUE(keys_.create("desk", roles));
  const auto read = keys_.load();
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(read->name, "desk");
  EXPECT_EQ(read->roles, roles);
}

TEST_F(KeyFolderTest, NoKeySaysHowToMakeOne) {
  const auto read = keys_.load();
  ASSERT_FALSE(read);
  EXPECT_NE(read.message().find("`handrail keys new`"), std::string::npos);
}

TEST_F(KeyFolderTest, AKeyThatOthersCouldReadIsRefused) {
  ASSERT_TRUE(keys_.create("cell", Role::kSlave));
  for (const mode_t mode : {0640u, 0604u, 0660u, 0602u, 0666u, 0610u}) {
    ASSERT_EQ(::chmod(keys_.key_path().c_str(), mode), 0);
    const auto read = keys_.load();
    ASSERT_FALSE(read) << std::oct << mode;
    EXPECT_NE(read.message().find("expected 0600"), std::string::npos);
  }
  ASSERT_EQ(::chmod(keys_.key_path().c_str(), 0400), 0);
  EXPECT_TRUE(keys_.load());
}

TEST_F(KeyFolderTest, AListThatOthersCouldWriteIsRefused) {
  TrustList list;
  ASSERT_TRUE(list.add({"desk", Role::kMaster, key()}));
  ASSERT_TRUE(keys_.save(list, "a test"));
  EXPECT_EQ(*keys_.trusted(), list);
  ASSERT_EQ(::chmod(keys_.trusted_path().c_str(), 0644), 0);
  EXPECT_TRUE(keys_.trusted());
  ASSERT_EQ(::chmod(keys_.trusted_path().c_str(), 0666), 0);
  const auto read = keys_.trusted();
  ASSERT_FALSE(read);
  EXPECT_NE(read.message().find("has mode 0666"), std::string::npos);
}

TEST_F(KeyFolderTest, TrustingKeepsWhatElseStandsInTheList) {
  const std::string said = "# mine\nben observer " + key_text(key()) + " # upstairs\n";
  folder_.write("a/handrail/trusted", said);
  ASSERT_EQ(::chmod(keys_.trusted_path().c_str(), 0600), 0);
  const Trusted desk{"desk", Role::kMaster, key()};
  const auto done = keys_.trust(desk, ", as a test");
  ASSERT_TRUE(done) << done.message();
  EXPECT_EQ(*done, "trusted desk as master, key " + key_id(desk.key));
  EXPECT_EQ(text_of(keys_.trusted_path()), said + line_text(desk) + "\n");
  EXPECT_NE(text_of(keys_.history_path()).find(*done + ", as a test\n"), std::string::npos);
  ASSERT_TRUE(keys_.distrust("desk"));
  EXPECT_EQ(text_of(keys_.trusted_path()), said);
  EXPECT_FALSE(keys_.distrust("desk"));
}

TEST_F(KeyFolderTest, ANewListSaysWhatItIs) {
  ASSERT_TRUE(keys_.trust({"desk", Role::kMaster, key()}));
  EXPECT_EQ(text_of(keys_.trusted_path()).rfind("# Whom the programs of this user let in", 0), 0u);
}

TEST_F(KeyFolderTest, OurOwnKeyAndANameWithAnotherKeyAreNotTrustedAndNothingIsWritten) {
  const auto own = keys_.create("cell", Role::kSlave);
  ASSERT_TRUE(own && keys_.trust({"desk", Role::kMaster, key()}));
  const std::string before = text_of(keys_.trusted_path());
  for (const Trusted& entry : {own->entry(), Trusted{"desk", Role::kMaster, key()},
                               Trusted{"me", Role::kMaster, own->key.public_key()}}) {
    EXPECT_FALSE(keys_.may_trust(entry));
    EXPECT_FALSE(keys_.trust(entry));
  }
  EXPECT_EQ(text_of(keys_.trusted_path()), before);
}

TEST_F(KeyFolderTest, AListThatWouldBeTooLongToReadIsNotWritten) {
  ASSERT_TRUE(keys_.trust({"desk", Role::kMaster, key()}));
  folder_.write("a/handrail/trusted", "#" + std::string(64 * 1024 - 20, 'x') + "\n");
  const auto done = keys_.trust({"desk", Role::kMaster, key()});
  ASSERT_FALSE(done);
  EXPECT_NE(done.message().find("expected 65536 at most"), std::string::npos) << done.message();
  EXPECT_TRUE(keys_.trusted());
}

TEST_F(KeyFolderTest, TwoProgramsThatChangeTheListAtOnceLoseNothing) {
  constexpr int kEach = 40;
  ASSERT_TRUE(keys_.trust({"first", Role::kMaster, key()}));
  const auto add = [this](const std::string& who) {
    for (int i = 0; i < kEach; ++i) {
      EXPECT_TRUE(keys_.trust({who + std::to_string(i), Role::kMaster, key()}));
    }
  };
  std::thread other(add, "a");
  add("b");
  other.join();
  EXPECT_EQ(keys_.trusted()->entries().size(), 2u * kEach + 1);
}

TEST_F(KeyFolderTest, WithoutAListNobodyIsTrusted) {
  const auto read = keys_.trusted();
  ASSERT_TRUE(read) << read.message();
  EXPECT_TRUE(read->entries().empty());
}

TEST_F(KeyFolderTest, AListThatCannotBeReadIsNotTakenForAnEmptyOne) {
  ASSERT_TRUE(keys_.save(TrustList(), "a test"));
  folder_.write("a/handrail/trusted", "desk\n");
  const auto read = keys_.trusted();
  ASSERT_FALSE(read);
  EXPECT_NE(read.message().find(keys_.trusted_path() + ":1:"), std::string::npos);
}

TEST_F(KeyFolderTest, TheStampChangesWithKeyAndList) {
  const std::string none = keys_.stamp();
  ASSERT_TRUE(keys_.create("cell", Role::kSlave));
  const std::string key_only = keys_.stamp();
  EXPECT_NE(none, key_only);
  ASSERT_TRUE(keys_.create_next());
  const std::string with_next = keys_.stamp();
  EXPECT_NE(key_only, with_next);
  ASSERT_TRUE(keys_.save(TrustList(), "a test"));
  const std::string both = keys_.stamp();
  EXPECT_NE(with_next, both);
  EXPECT_EQ(both, keys_.stamp());
  ASSERT_EQ(::chmod(keys_.trusted_path().c_str(), 0666), 0);
  EXPECT_NE(both, keys_.stamp());
}

// A slave's folder whose key is being changed, and the masters that it trusts.
class NextKeyTest : public KeyFolderTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(keys_.create("cell", Role::kSlave));
    ASSERT_TRUE(keys_.trust(desk_) && keys_.trust(ben_));
    const auto made = keys_.create_next();
    ASSERT_TRUE(made) << made.message();
    old_ = made->key.public_key();
    next_ = made->next->public_key();
  }
  std::string history() const { return text_of(keys_.history_path()); }

  const Trusted desk_{"desk", Role::kMaster, key()}, ben_{"ben", Role::kObserver, key()};
  PublicKey old_, next_;
};

TEST_F(NextKeyTest, WaitsBesideTheOldOneWithTheSameNameAndRoles) {
  EXPECT_EQ(mode_of(keys_.next_path()), 0600u);
  const auto read = keys_.load();
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(read->entry(), (Trusted{"cell", Role::kSlave, old_, next_}));
  EXPECT_EQ(KeyFolder::waits_for(*read, *keys_.trusted()), std::vector<std::string>{"desk"});
  EXPECT_FALSE(keys_.create_next());
  EXPECT_FALSE(keys_.may_trust({"x", Role::kMaster, next_}));
}

TEST_F(NextKeyTest, TakesTheKeysPlaceWhenTheLastMasterHasOpenedASessionWithIt) {
  const Trusted north{"north", Role::kMaster, key()};
  ASSERT_TRUE(keys_.trust(north));
  ASSERT_TRUE(keys_.confirm(next_, desk_.key));
  EXPECT_EQ(keys_.load()->entry().next, next_);
  EXPECT_EQ(keys_.load()->confirmed, std::vector<std::string>{"desk"});
  ASSERT_TRUE(keys_.confirm(next_, desk_.key));  // again: nothing more
  EXPECT_EQ(keys_.load()->entry().next, next_);
  ASSERT_TRUE(keys_.confirm(next_, north.key));
  EXPECT_EQ(keys_.load()->entry(), (Trusted{"cell", Role::kSlave, next_}));
  EXPECT_FALSE(std::filesystem::exists(keys_.next_path()));
  EXPECT_EQ(mode_of(keys_.key_path()), 0600u);
  EXPECT_NE(history().find("next key " + key_id(next_) + " is confirmed by desk\n"),
            std::string::npos);
  EXPECT_NE(history().find("retired key " + key_id(old_) + " of cell for " + key_id(next_) +
                           ", confirmed by north\n"),
            std::string::npos);
}

TEST_F(NextKeyTest, NobodyElseAndNoOtherKeyConfirmsIt) {
  ASSERT_TRUE(keys_.confirm(next_, ben_.key));  // leads nothing
  ASSERT_TRUE(keys_.confirm(next_, key()));
  ASSERT_TRUE(keys_.confirm(old_, desk_.key));
  EXPECT_EQ(keys_.load()->entry().next, next_);
  EXPECT_TRUE(keys_.load()->confirmed.empty());
}

TEST_F(NextKeyTest, CanBeTakenByHand) {
  ASSERT_TRUE(keys_.retire());
  EXPECT_EQ(keys_.load()->entry(), (Trusted{"cell", Role::kSlave, next_}));
  EXPECT_NE(history().find("by hand"), std::string::npos);
  EXPECT_FALSE(keys_.retire());
}

TEST_F(NextKeyTest, WhatAnEndInTheMiddleLeavesIsOneKey) {
  const std::string text = text_of(keys_.next_path());
  ASSERT_TRUE(keys_.retire());
  folder_.write("a/handrail/key.next", text);
  ASSERT_EQ(::chmod(keys_.next_path().c_str(), 0600), 0);
  EXPECT_EQ(keys_.load()->entry(), (Trusted{"cell", Role::kSlave, next_}));
  EXPECT_TRUE(keys_.create_next());
}

TEST_F(NextKeyTest, AKeyThatIsLostIsMadeAnewAndItsNextOneGoes) {
  std::filesystem::remove(keys_.key_path());
  EXPECT_FALSE(keys_.load());
  const auto made = keys_.create("cell", Role::kSlave);
  ASSERT_TRUE(made) << made.message();
  EXPECT_EQ(keys_.load()->entry(), made->entry());
  EXPECT_NE(history().find("made key " + key_id(made->key.public_key()) + " of cell\n"),
            std::string::npos);
  EXPECT_NE(history().find("removed the next key of one that is lost\n"), std::string::npos);
}

TEST_F(NextKeyTest, OneThatOthersCouldReadIsRefusedAndNamed) {
  ASSERT_EQ(::chmod(keys_.next_path().c_str(), 0640), 0);
  const auto read = keys_.load();
  ASSERT_FALSE(read);
  EXPECT_EQ(read.message().rfind(keys_.next_path() + ": has mode 0640", 0), 0u) << read.message();
}

TEST_F(NextKeyTest, OfTheOtherSideReplacesItsKeyInTheListAtItsFirstSession) {
  const PublicKey newer = key();
  ASSERT_TRUE(keys_.trust({"desk", Role::kMaster, desk_.key, newer}));
  ASSERT_TRUE(keys_.confirm(old_, desk_.key));
  EXPECT_EQ(keys_.trusted()->find("desk")->next, newer);
  ASSERT_TRUE(keys_.confirm(old_, newer));
  EXPECT_EQ(*keys_.trusted()->find("desk"), (Trusted{"desk", Role::kMaster, newer}));
  EXPECT_EQ(keys_.trusted()->find(desk_.key), nullptr);
  EXPECT_NE(history().find("desk has changed its key: " + key_id(desk_.key) +
                           " is trusted no longer, " + key_id(newer) + " is\n"),
            std::string::npos);
  const std::string before = history();
  ASSERT_TRUE(keys_.confirm(old_, newer));
  EXPECT_EQ(history(), before);
}

TEST_F(KeyFolderTest, WhoHasChangedItsKeyAlreadyIsSaidToBeTrustedWithTheNewOneAlone) {
  const PublicKey old_key = key(), new_key = key();
  ASSERT_TRUE(keys_.trust({"desk", Role::kMaster, new_key}));
  const auto said = keys_.trust({"desk", Role::kMaster, old_key, new_key});
  ASSERT_TRUE(said) << said.message();
  EXPECT_EQ(*said, "trusted desk as master, key " + key_id(new_key));
}

}  // namespace
}  // namespace handrail
