#include <gtest/gtest.h>

#include "server/keys/own_key.h"
#include "server/keys/trust_list.h"

namespace handrail {
namespace {

// Made by openssl(1): ecparam -name prime256v1 -genkey, pkcs8 -topk8, ec -pubout -conv_form
// compressed. Nobody trusts it.
constexpr char kPem[] =
    "-----BEGIN PRIVATE KEY-----\n"
    "MIGHAgEAMBMGByqGSM49AgEGCCqGSM49AwEHBG0wawIBAQQgJqtVsbtsaR2VBMla\n"
    "w5ThHeHSenAB71+S2pl5MOgu+1qhRANCAAR/nM+Po7qnVmjAYxECHBuv1oDhnjlM\n"
    "2jz+HNqVOGwBb+k+Ioswtm9/HMgEkZaj9W2ifXswwTIZBOHdYFFonqFd\n"
    "-----END PRIVATE KEY-----\n";
constexpr char kPublic[] = "p256:A3+cz4+juqdWaMBjEQIcG6/WgOGeOUzaPP4c2pU4bAFv";
constexpr char kOther[] = "p256:A2cLxkDqBPNRAVkoFOoE676xp64Yx679QWHcO18oJYeU";

TEST(Keys, ThePublicHalfIsWhatOpensslSays) {
  const auto key = OwnKey::parse(kPem);
  ASSERT_TRUE(key) << key.message();
  EXPECT_EQ(key_text(key->public_key()), kPublic);
  EXPECT_EQ(key->pem(), kPem);
}

TEST(Keys, AKeyIsReadAsItWasWritten) {
  const auto key = parse_key(kPublic);
  ASSERT_TRUE(key) << key.message();
  EXPECT_EQ(key_text(*key), kPublic);
  // sha256sum of the 33 bytes.
  EXPECT_EQ(key_id(*key), "d3c4-50ec-d92f-e0ca");
}

TEST(Keys, WhatIsNoKeyIsRefusedWithWhatWasExpected) {
  const std::string good = kPublic;
  for (const std::string& text :
       {std::string(), std::string("p256:"), good.substr(0, good.size() - 1), good + "=",
        "rsa" + good, "p256:B" + good.substr(6), good.substr(0, 20) + "!" + good.substr(21),
        std::string(10000, 'a')}) {
    const auto key = parse_key(text);
    ASSERT_FALSE(key) << text;
    EXPECT_NE(key.message().find("expected p256:"), std::string::npos);
    EXPECT_LT(key.message().size(), 200u);
  }
}

TEST(Keys, WhatIsNoPrivateKeyIsRefused) {
  for (const char* text :
       {"", "-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n", "ssh-ed25519 AAAA"}) {
    EXPECT_FALSE(OwnKey::parse(text)) << text;
  }
}

TEST(TrustList, ReadsNamesRolesAndKeysAndCommentsDoNotCount) {
  const auto list =
      TrustList::parse(std::string("# the cell\n\n  desk  master,operator\t") + kPublic +
                           " # by the door\nben observer " + kOther + "\r\n",
                       "trusted");
  ASSERT_TRUE(list) << list.message();
  ASSERT_EQ(list->entries().size(), 2u);
  const Trusted* desk = list->find("desk");
  ASSERT_NE(desk, nullptr);
  EXPECT_TRUE(desk->roles.has(Role::kMaster) && desk->roles.has(Role::kOperator));
  EXPECT_FALSE(desk->roles.has(Role::kSlave) || desk->roles.has(Role::kObserver));
  EXPECT_EQ(list->find(*parse_key(kOther))->name, "ben");
  EXPECT_EQ(list->find(PublicKey()), nullptr);
  EXPECT_EQ(*TrustList::parse(list->text(), "again"), *list);
}

TEST(TrustList, NamesTheLineThatIsWrong) {
  const std::string good = std::string("desk master ") + kPublic + "\n";
  for (const auto& [line, says] :
       {std::pair<std::string, std::string>{"desk master", "expected NAME"},
        {std::string("a b c ") + kOther, "roles 'b'"},
        {std::string("ben master ") + kOther + " " + kOther + " x", "expected NAME"},
        {std::string("b@d master ") + kOther, "is no name"},
        {std::string("ben king ") + kOther, "roles 'king'"},
        {std::string("ben master, ") + kOther, "roles 'master,'"},
        {"ben master p256:xyz", "is no key"},
        {std::string("desk master ") + kOther, "is here already with key"},
        {std::string("ben master ") + kPublic, "is here already as 'desk'"}}) {
    const auto list = TrustList::parse(good + line, "/keys/trusted");
    ASSERT_FALSE(list) << line;
    EXPECT_EQ(list.message().rfind("/keys/trusted:2: ", 0), 0u) << list.message();
    EXPECT_NE(list.message().find(says), std::string::npos) << list.message();
  }
}

TEST(TrustList, CommentsBlankLinesAndOrderStayWhenItIsWrittenAgain) {
  const std::string before =
      "# the cell\n\n  desk \t master " + std::string(kPublic) + "   # by the door\n#ben left\n";
  const std::string ben = std::string("ben observer ") + kOther;
  auto list = TrustList::parse(before + ben + "\n# the end", "trusted");
  ASSERT_TRUE(list) << list.message();
  EXPECT_EQ(list->text(), before + ben + "\n# the end\n");
  // The same again changes nothing; other roles change their own line alone.
  ASSERT_TRUE(list->add({"desk", Role::kMaster, *parse_key(kPublic)}));
  EXPECT_EQ(list->text(), before + ben + "\n# the end\n");
  ASSERT_TRUE(list->add({"desk", Role::kObserver, *parse_key(kPublic)}));
  EXPECT_EQ(list->text(), "# the cell\n\ndesk observer " + std::string(kPublic) +
                              " # by the door\n#ben left\n" + ben + "\n# the end\n");
  EXPECT_TRUE(list->remove("desk"));
  EXPECT_EQ(list->text(), "# the cell\n\n#ben left\n" + ben + "\n# the end\n");
  ASSERT_TRUE(list->add({"desk", Role::kMaster, *parse_key(kPublic)}));
  EXPECT_EQ(list->text(),
            "# the cell\n\n#ben left\n" + ben + "\n# the end\ndesk master " + kPublic + "\n");
}

TEST(TrustList, AnEntryThatComesTwiceIsWrittenOnce) {
  const std::string desk = std::string("desk master ") + kPublic;
  const auto list = TrustList::parse(desk + "\n# x\ndesk observer " + kPublic + "\n", "trusted");
  ASSERT_TRUE(list) << list.message();
  EXPECT_EQ(list->text(), std::string("desk observer ") + kPublic + "\n# x\n");
}

TEST(TrustList, WhatItQuotesIsPlainText) {
  for (const char* line :
       {"de\x1bsk master p256:", "desk mas\x1bter p256:", "desk master p2\x1b"}) {
    const auto list = TrustList::parse(line, "trusted");
    ASSERT_FALSE(list);
    EXPECT_EQ(list.message().find('\x1b'), std::string::npos) << list.message();
  }
}

TEST(TrustList, ANextKeyStandsBehindTheKeyAndIsLetInToo) {
  const std::string line = std::string("desk master ") + kPublic + " " + kOther;
  auto list = TrustList::parse(line + "\n", "trusted");
  ASSERT_TRUE(list) << list.message();
  const Trusted both{"desk", Role::kMaster, *parse_key(kPublic), *parse_key(kOther)};
  EXPECT_EQ(list->entries(), std::vector{both});
  EXPECT_EQ(line_text(both), line);
  EXPECT_EQ(list->find(*parse_key(kOther)), list->find("desk"));
  EXPECT_EQ(both.newest(), *parse_key(kOther));
  // Nobody else may have it.
  EXPECT_FALSE(list->add({"ben", Role::kMaster, *parse_key(kOther)}));
  for (const char* wrong : {kPublic, "p256:x"}) {
    EXPECT_FALSE(TrustList::parse(std::string("desk master ") + kPublic + " " + wrong, "trusted"));
  }
}

TEST(TrustList, ANextKeyComesWithTheKeyAndTakesItsPlace) {
  const Trusted desk{"desk", Role::kMaster, *parse_key(kPublic)};
  Trusted both = desk, newer = desk;
  both.next = newer.key = *parse_key(kOther);
  TrustList list;
  ASSERT_TRUE(list.add(desk));
  EXPECT_FALSE(list.add(newer));  // without the old one it could be anybody's
  EXPECT_FALSE(list.retire_before(newer.key));
  ASSERT_TRUE(list.add(both));
  EXPECT_FALSE(list.retire_before(desk.key));
  TrustList by_hand = list;
  EXPECT_EQ(list.retire_before(newer.key), both);
  EXPECT_EQ(list.entries(), std::vector{newer});
  EXPECT_EQ(list.text(), line_text(newer) + "\n");
  EXPECT_FALSE(list.add(desk));  // no way back
  ASSERT_TRUE(by_hand.add(newer));
  EXPECT_EQ(by_hand, list);
}

TEST(TrustList, WhoHasChangedItsKeyHereAlreadyMayComeWithBothAgain) {
  TrustList list;
  const PublicKey old_key = OwnKey::generate()->public_key();
  const PublicKey new_key = OwnKey::generate()->public_key();
  ASSERT_TRUE(list.add({"desk", Role::kMaster, new_key}));
  ASSERT_TRUE(list.add({"desk", Role::kMaster, old_key, new_key}))
      << "the others have yet to see it";
  EXPECT_EQ(list.find(old_key), nullptr) << "it was retired";
  EXPECT_EQ(list.text(), "desk master " + key_text(new_key) + "\n");
}

TEST(Roles, WhoHasSomethingToSayToWhom) {
  const auto both = [](Role a, Role b) { return meet(a, b) && meet(b, a); };
  EXPECT_TRUE(both(Role::kSlave, Role::kMaster) && both(Role::kMaster, Role::kOperator) &&
              both(Role::kMaster, Role::kObserver));
  for (const Role role : {Role::kMaster, Role::kSlave, Role::kOperator, Role::kObserver}) {
    EXPECT_FALSE(meet(role, role));
    EXPECT_FALSE(meet(role, Roles()));
  }
  EXPECT_FALSE(meet(Role::kSlave, Role::kOperator) || meet(Role::kObserver, Role::kOperator));
}

TEST(TrustList, TheSameNameAndKeyGetTheRolesTheyComeWith) {
  TrustList list;
  ASSERT_TRUE(list.add({"desk", Role::kMaster, *parse_key(kPublic)}));
  ASSERT_TRUE(list.add({"desk", Role::kObserver, *parse_key(kPublic)}));
  EXPECT_EQ(list.find("desk")->roles, Roles(Role::kObserver));
  EXPECT_TRUE(list.remove("desk"));
  EXPECT_FALSE(list.remove("desk"));
}

}  // namespace
}  // namespace handrail
