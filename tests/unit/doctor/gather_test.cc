// What is read from this computer, on places made up for it and on what every Linux has.
#include "client/doctor/gather.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using testing::HasSubstr;

class DoctorKeyFolder : public ::testing::Test {
 protected:
  KeyFacts facts() const { return key_facts(folder_.path()); }

  TempFolder folder_;
  KeyFolder keys_{folder_.path()};
};

TEST_F(DoctorKeyFolder, AnEmptyOneHasNoKeyAndTrustsNobody) {
  const KeyFacts found = facts();
  EXPECT_FALSE(found.has_key || found.own);
  EXPECT_EQ(found.key_mode, "");
  ASSERT_TRUE(found.trusted);
  EXPECT_TRUE(found.trusted->entries().empty());
}

TEST_F(DoctorKeyFolder, AKeyIsReadWithItsModeAndItsAge) {
  const auto made = keys_.create("desk", Role::kMaster);
  ASSERT_TRUE(made && keys_.save(TrustList(), "a test"));
  const KeyFacts found = facts();
  ASSERT_TRUE(found.own);
  EXPECT_EQ(*found.own, made->entry());
  EXPECT_EQ(found.key_mode, "0600");
  EXPECT_EQ(found.trusted_mode, "0600");
  EXPECT_TRUE(found.key_is_private && found.trusted_is_ours_to_write);
  EXPECT_LT(found.own_age_s, 60.0);
  const timespec old[2] = {{1000, 0}, {1000, 0}};
  ASSERT_EQ(::utimensat(AT_FDCWD, found.key_path.c_str(), old, 0), 0);
  EXPECT_GT(facts().own_age_s, 1e9);
}

TEST_F(DoctorKeyFolder, WhatOthersMayReadOrWriteIsSeen) {
  ASSERT_TRUE(keys_.create("desk", Role::kMaster) && keys_.save(TrustList(), "a test"));
  ASSERT_EQ(::chmod(keys_.key_path().c_str(), 0640), 0);
  ASSERT_EQ(::chmod(keys_.trusted_path().c_str(), 0644), 0);
  KeyFacts found = facts();
  EXPECT_FALSE(found.key_is_private || found.own);
  EXPECT_EQ(found.key_mode, "0640");
  EXPECT_TRUE(found.trusted_is_ours_to_write) << "reading the list is no harm";
  ASSERT_EQ(::chmod(keys_.trusted_path().c_str(), 0664), 0);
  found = facts();
  EXPECT_FALSE(found.trusted_is_ours_to_write || found.trusted);
}

TEST_F(DoctorKeyFolder, WhatCannotBeReadIsQuoted) {
  folder_.write("key", "nonsense\n");
  folder_.write("trusted", "one two three\n");
  ASSERT_EQ(::chmod(keys_.key_path().c_str(), 0600), 0);
  const KeyFacts found = facts();
  EXPECT_TRUE(found.has_key && !found.own && !found.trusted);
  EXPECT_THAT(found.own_problem, HasSubstr(keys_.key_path()));
  EXPECT_THAT(found.trusted_problem, HasSubstr(keys_.trusted_path()));
}

TEST(DoctorRouteFacts, TheWayToThisComputerGoesThroughItsLoopback) {
  const RouteFacts found = route_facts("127.0.0.1:47002");
  EXPECT_EQ(found.problem, "");
  EXPECT_EQ(found.interface, "lo");
  EXPECT_GT(found.mtu, 1280);
  EXPECT_FALSE(found.v6);
  EXPECT_EQ(found.tunnel, Tunnel::kNone);
  const RouteFacts v6 = route_facts("[::1]:47002");
  if (!v6.problem.empty()) GTEST_SKIP() << "no IPv6 here: " << v6.problem;
  EXPECT_TRUE(v6.v6);
  EXPECT_EQ(v6.interface, "lo");
  EXPECT_GT(v6.mtu, 1280);
}

TEST(DoctorRouteFacts, WhereNoWayLeadsIsSaid) {
  EXPECT_NE(route_facts("localhost:47002").problem, "") << "a name is not looked up";
  EXPECT_NE(route_facts("").problem, "");
  EXPECT_NE(route_facts("255.255.255.255:47002").problem, "") << "everybody is nobody";
}

TEST(DoctorMachineFacts, AreThoseOfThisComputer) {
  const MachineFacts found = machine_facts();
  EXPECT_NE(found.user, "");
  EXPECT_GE(found.most_priority, -1);
  EXPECT_GE(found.most_locked_kb, -1);
  EXPECT_LE(found.most_priority, 99);
}

TEST(DoctorMaster, WithoutOneTheMachineIsWatchedAllTheSame) {
  MachineFacts machine;
  const MasterFacts found = watch_master("/nowhere/operator.sock", 0.2, nullptr, machine);
  EXPECT_FALSE(found.status);
  EXPECT_TRUE(found.absent);
  EXPECT_THAT(found.problem, HasSubstr("/nowhere/operator.sock: no such socket"));
  EXPECT_GE(machine.watched_s, 0.2);
  EXPECT_GE(machine.pauses, 0);
}

}  // namespace
}  // namespace handrail
