// Who drives, in virtual time: every rule of the lease.
#include "server/master/lease.h"

#include <gmock/gmock.h>

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class LeaseTest : public ::testing::Test {
 protected:
  LeaseTest() {
    (void)lease.drive("anna", true, now);
    (void)lease.take_news();
  }
  // `seconds` later, polled as the desk does.
  void pass(int seconds, bool engaged = false) {
    for (int i = 0; i < seconds * 10; ++i) lease.poll(engaged, now += kSecond / 10);
  }
  std::string take(const std::string& who) { return lease.take(who, now).refusal; }
  std::string drive(const std::string& who, bool engages = false) {
    return lease.drive(who, engages, now).refusal;
  }

  Lease lease;
  Nanos now = 1000 * kSecond;
};

TEST_F(LeaseTest, AFreeOneLetsAnybodyOrderAndGoesToWhoEngages) {
  Lease free;
  EXPECT_TRUE(free.drive("ben", false, now).allowed);
  EXPECT_EQ(free.holder(), "");
  EXPECT_TRUE(free.drive("ben", true, now).allowed);
  EXPECT_EQ(free.holder(), "ben");
  EXPECT_THAT(free.take_news(), ElementsAre("ben has the lease by engaging"));
}

TEST_F(LeaseTest, OnlyTheHolderMayOrderAndOthersAreToldWhoSinceWhenAndHowToAsk) {
  pass(40);
  EXPECT_EQ(drive("anna"), "");
  pass(2);
  const char* why =
      "anna has the lease for 42 s (last order 2 s ago): 'handrail lease take' asks for it";
  EXPECT_EQ(drive("ben"), why);
  EXPECT_EQ(drive("ben", true), why);
  EXPECT_EQ(lease.grant("ben", now).refusal, why);
  EXPECT_EQ(lease.refuse("ben", now).refusal, why);
  EXPECT_EQ(lease.release("ben", now).refusal, why);
  EXPECT_EQ(lease.holder(), "anna");
  EXPECT_THAT(lease.take_news(), IsEmpty());
}

TEST_F(LeaseTest, LongTimesAreInMinutesAndHours) {
  pass(300, true);
  EXPECT_EQ(drive("ben").substr(0, 28), "anna has the lease for 5 min");
  pass(3 * 3600, true);
  EXPECT_EQ(drive("ben").substr(0, 32), "anna has the lease for 3 h 5 min");
}

TEST_F(LeaseTest, ItTimesOutWithoutOrdersAndNeverWhileEngaged) {
  pass(600, true);
  EXPECT_EQ(lease.holder(), "anna");
  pass(59);
  EXPECT_EQ(drive("anna"), "");
  pass(60);
  EXPECT_EQ(lease.holder(), "anna");
  pass(1);
  EXPECT_EQ(lease.holder(), "");
  EXPECT_THAT(lease.take_news(), ElementsAre("the lease of anna has timed out"));
}

TEST_F(LeaseTest, ReleasedItIsFree) {
  EXPECT_TRUE(lease.release("anna", now).allowed);
  EXPECT_EQ(lease.holder(), "");
  EXPECT_THAT(lease.take_news(), ElementsAre("anna releases the lease"));
  EXPECT_EQ(lease.release("anna", now).refusal,
            "nobody holds the lease: 'handrail lease take' takes it");
  EXPECT_EQ(take("ben"), "");
  EXPECT_EQ(lease.holder(), "ben");
}

TEST_F(LeaseTest, AHeldOneIsAskedForAndGranted) {
  EXPECT_EQ(lease.grant("anna", now).refusal, "nobody asks for the lease");
  EXPECT_EQ(take("ben"), "");
  EXPECT_EQ(lease.holder(), "anna");
  EXPECT_EQ(lease.asked_by(), "ben");
  pass(3);
  EXPECT_EQ(lease.ask_left(now), 7 * kSecond);
  EXPECT_TRUE(lease.grant("anna", now).allowed);
  EXPECT_EQ(lease.holder(), "ben");
  EXPECT_EQ(lease.asked_by(), "");
  EXPECT_THAT(lease.take_news(),
              ElementsAre("ben asks anna for the lease", "ben has the lease, granted by anna"));
  EXPECT_NE(drive("anna"), "");
}

TEST_F(LeaseTest, AHeldOneIsAskedForAndRefused) {
  EXPECT_EQ(lease.refuse("anna", now).refusal, "nobody asks for the lease");
  (void)take("ben");
  EXPECT_TRUE(lease.refuse("anna", now).allowed);
  EXPECT_EQ(lease.holder(), "anna");
  EXPECT_EQ(lease.asked_by(), "");
  EXPECT_THAT(lease.take_news(), ElementsAre("ben asks anna for the lease",
                                             "ben does not get the lease: anna refuses"));
}

TEST_F(LeaseTest, ReleasedItGoesToWhoAsks) {
  (void)take("ben");
  EXPECT_TRUE(lease.release("anna", now).allowed);
  EXPECT_EQ(lease.holder(), "ben");
}

TEST_F(LeaseTest, OneMayAskAtATime) {
  (void)take("ben");
  pass(4);
  EXPECT_EQ(take("carl"), "ben has asked anna for the lease already; 6 s left for the answer");
  EXPECT_EQ(take("ben"), "");
  EXPECT_EQ(lease.ask_left(now), 6 * kSecond) << "asking again does not wait again";
  EXPECT_EQ(take("anna"), "") << "the holder has it";
  EXPECT_EQ(lease.asked_by(), "ben");
}

TEST_F(LeaseTest, AQuestionToAHolderWhoIsNotThereIsGrantedAfterTenSeconds) {
  (void)take("ben");
  pass(9);
  EXPECT_EQ(lease.holder(), "anna");
  pass(1);
  EXPECT_EQ(lease.holder(), "ben");
  EXPECT_EQ(lease.take_news().back(), "ben has the lease: anna does not answer");
}

TEST_F(LeaseTest, AQuestionToAHolderWhoDrivesIsRefusedAfterTenSeconds) {
  (void)take("ben");
  pass(10, true);
  EXPECT_EQ(lease.holder(), "anna");
  EXPECT_EQ(lease.asked_by(), "");
  EXPECT_EQ(lease.take_news().back(),
            "ben does not get the lease: anna drives and does not answer");
  (void)take("carl");
  pass(5);
  EXPECT_EQ(drive("anna"), "");
  pass(5);
  EXPECT_EQ(lease.holder(), "anna") << "one order since shows that somebody is there";
}

}  // namespace
}  // namespace handrail
