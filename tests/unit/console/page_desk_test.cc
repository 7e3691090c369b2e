// What pages ask for and are told, with a master and pages that the test plays.
#include "client/console/gateway/page_desk.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Played : public PageSink, public MasterOrders {
 public:
  void send(PageId page, SharedText frame, bool, FrameWorth worth) override {
    pb::ToPage read;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(*frame, &read).ok()) << *frame;
    frames[page].push_back(read);
    texts.push_back(frame);
    slots.push_back(worth.slot);
  }
  void end(PageId page, std::uint16_t code, const std::string& why) override {
    ended[page] = std::to_string(code) + " " + why;
  }
  void order(std::uint64_t ticket, const pb::Request& request) override {
    orders.emplace_back(ticket, request);
  }
  void withdraw(std::uint64_t ticket) override { withdrawn.push_back(ticket); }
  void point(const pb::CursorOrder& cursor) override { cursors.push_back(cursor); }

  std::map<PageId, std::vector<pb::ToPage>> frames;
  std::vector<SharedText> texts;
  std::vector<int> slots;
  std::map<PageId, std::string> ended;
  std::vector<std::pair<std::uint64_t, pb::Request>> orders;
  std::vector<std::uint64_t> withdrawn;
  std::vector<pb::CursorOrder> cursors;
};

class PageDeskTest : public ::testing::Test {
 protected:
  explicit PageDeskTest(bool observe = false)
      : desk(played, played, {observe, "1.2", "console", "/run/op.sock", {"gearshift", "plane"}}) {
    desk.opened(1, false, now);
    desk.opened(2, false, now);
  }
  void say(PageId page, const std::string& json) { desk.received(page, json, now); }
  // The newest reply that this page has, in short; "" where there is none.
  std::string reply(PageId page) const {
    std::string out;
    for (const pb::ToPage& frame : played.frames.at(page)) {
      if (!frame.has_reply()) continue;
      const pb::PageReply& r = frame.reply();
      out = std::to_string(r.id()) + (r.done() ? " done" : " refused") +
            (r.reason().empty() ? "" : ": " + r.reason());
    }
    return out;
  }
  pb::Hello hello(PageId page) const {
    pb::Hello out;
    for (const pb::ToPage& frame : played.frames.at(page)) {
      if (frame.has_hello()) out = frame.hello();
    }
    return out;
  }
  void answer(bool done, const std::string& reason = "") {
    pb::Reply r;
    r.set_done(done);
    if (!reason.empty()) r.set_reason(reason);
    desk.answered(played.orders.back().first, r, now);
  }
  void leads(PageId page, const std::string& act = "TAKE") {
    say(page, R"({"lead": {"id": 9, "act": ")" + act + "\"}}");
    answer(true);
    ASSERT_EQ(desk.leader(), page) << reply(page);
  }

  Played played;
  PageDesk desk;
  Nanos now = 100 * kSecond;
};

TEST_F(PageDeskTest, GreetsEachPageWithWhoItIsAndWhatTheLimitsAre) {
  const pb::Hello greeting = hello(2);
  EXPECT_EQ(greeting.version(), "1.2");
  EXPECT_EQ(greeting.page(), 2u);
  EXPECT_EQ(greeting.leader(), 0u);
  EXPECT_EQ(greeting.role(), pb::Hello::OPERATOR);
  EXPECT_EQ(greeting.name(), "console");
  EXPECT_EQ(greeting.master(), "/run/op.sock");
  EXPECT_THAT(greeting.scene(), ElementsAre("gearshift", "plane"));
  EXPECT_EQ(greeting.limits().pages_most(), 50u);
  EXPECT_EQ(greeting.limits().status_hz(), 60.0);
}

TEST_F(PageDeskTest, AStatusIsWrittenOnceForAllPagesAndOnlyTheNewestWaits) {
  pb::Reply r;
  r.set_done(true);
  r.mutable_status()->set_state("engaged");
  r.mutable_status()->set_ticks(1234567890123);
  const std::size_t before = played.texts.size();
  desk.status(r, now, now + 3 * kMillisecond);
  ASSERT_EQ(played.texts.size(), before + 2);
  EXPECT_EQ(played.texts[before], played.texts[before + 1]) << "one text";
  EXPECT_GE(played.slots.back(), 0) << "may be left out";
  EXPECT_THAT(*played.texts.back(), HasSubstr(R"("ticks":"1234567890123")"));
  const pb::StatusNews news = played.frames[2].back().status();
  EXPECT_EQ(news.status().state(), "engaged");
  EXPECT_EQ(news.age_ms(), 0.0);
  EXPECT_EQ(news.round_trip_ms(), 3.0);
  EXPECT_EQ(news.pages(), 2u);
}

TEST_F(PageDeskTest, AMasterThatIsGoneIsSaidWithTheAgeOfWhatIsKnown) {
  pb::Reply r;
  r.set_done(true);
  r.mutable_status()->set_state("off");
  desk.status(r, now, now);
  desk.status(Status::error("no master on /run/op.sock: start handrail-master"), now,
              now + 700 * kMillisecond);
  const pb::StatusNews news = played.frames[1].back().status();
  EXPECT_FALSE(news.has_status());
  EXPECT_EQ(news.problem(), "no master on /run/op.sock: start handrail-master");
  EXPECT_NEAR(news.age_ms(), 700.0, 1e-6);
}

TEST_F(PageDeskTest, AStatusHasWhatTheRigSaysWhereThereIsOne) {
  pb::Reply r;
  r.set_done(true);
  r.mutable_status()->set_state("off");
  desk.status(r, now, now);
  EXPECT_FALSE(played.frames[1].back().status().has_rig()) << "a real arm has none";
  pb::RigNews rig;
  rig.set_scene("screw-fastening");
  rig.mutable_moment()->mutable_screw()->set_turned_deg(90.0);
  desk.rig(rig);
  desk.status(r, now, now);
  EXPECT_EQ(played.frames[1].back().status().rig().moment().screw().turned_deg(), 90.0);
  // Also while the master is silent.
  desk.status(Status::error("no master"), now, now);
  EXPECT_EQ(played.frames[1].back().status().rig().scene(), "screw-fastening");
}

TEST_F(PageDeskTest, OrdersPassFromThePageThatLeadsAndItsRepliesComeBack) {
  say(1, R"({"request": {"id": 3, "order": {"engage": true}}})");
  EXPECT_EQ(reply(1), "3 refused: no page leads: send `lead` first");
  leads(1);
  EXPECT_EQ(played.orders.back().second.lease().act(), pb::LeaseOrder::TAKE);
  EXPECT_EQ(reply(1), "9 done");
  say(1, R"({"request": {"id": 4, "order": {"engage": true}}})");
  EXPECT_TRUE(played.orders.back().second.engage());
  answer(false, "the link is not good enough");
  EXPECT_EQ(reply(1), "4 refused: the link is not good enough");
  EXPECT_EQ(hello(2).leader(), 1u) << "the other page knows";
}

TEST_F(PageDeskTest, TheOtherPageIsToldWhoLeadsAndHowToTakeOver) {
  leads(1);
  now += 12 * kSecond;
  say(2, R"({"request": {"id": 5, "order": {"reset": true}}})");
  EXPECT_THAT(reply(2), AllOf(HasSubstr("5 refused: page 1 leads"), HasSubstr("TAKE_OVER")));
  say(2, R"({"lead": {"id": 6, "act": "TAKE"}})");
  EXPECT_EQ(reply(2),
            "6 refused: page 1 leads, for 12 s: send act TAKE_OVER to drive from this one");
  EXPECT_EQ(desk.leader(), 1u);
  leads(2, "TAKE_OVER");
  EXPECT_EQ(hello(1).leader(), 2u);
  EXPECT_EQ(hello(1).leader_text(), "page 2, for 0 s");
}

TEST_F(PageDeskTest, ALeaseThatTheMasterRefusesMakesNoLeader) {
  say(1, R"({"lead": {"id": 7}})");
  EXPECT_EQ(desk.leader(), 1u);
  answer(false, "ann has the lease");
  EXPECT_EQ(reply(1), "7 refused: ann has the lease");
  EXPECT_EQ(desk.leader(), 0u);
  EXPECT_EQ(hello(2).leader(), 0u);
}

TEST_F(PageDeskTest, AStopPassesFromAnyPageHoweverMuchWaits) {
  leads(1);
  for (std::uint32_t i = 0; i < PageDesk::kMostRequests; ++i) {
    say(1, R"({"request": {"id": 20, "order": {"engage": true}}})");
  }
  say(1, R"({"request": {"id": 21, "order": {"engage": true}}})");
  EXPECT_THAT(reply(1), HasSubstr("21 refused: 8 requests"));
  for (const PageId page : {1u, 2u}) {
    const std::size_t before = played.orders.size();
    say(page, R"({"request": {"id": 22, "order": {"stop": true}}})");
    ASSERT_EQ(played.orders.size(), before + 1);
    EXPECT_TRUE(played.orders.back().second.stop());
  }
}

TEST_F(PageDeskTest, TheCursorPassesFromThePageThatLeadsWithNumbersThatRise) {
  say(1, R"({"hand": {"sequence": "1", "position_mm": [1, 2, 3], "held": true}})");
  EXPECT_THAT(played.cursors, IsEmpty()) << "it does not lead";
  leads(1);
  say(1, R"({"hand": {"sequence": "7", "position_mm": [1, 2, 3], "held": true}})");
  say(1, R"({"hand": {"sequence": "7", "position_mm": [9, 9, 9], "held": true}})");
  say(1, R"({"hand": {"sequence": "1", "position_mm": [4, 5, 6], "held": true}})");
  ASSERT_EQ(played.cursors.size(), 2u) << "the same one again is left out";
  EXPECT_EQ(played.cursors[0].position_mm(2), 3.0);
  EXPECT_GT(played.cursors[1].sequence(), played.cursors[0].sequence());
}

TEST_F(PageDeskTest, AHandIsLetGoAtOnceWhenItsPageGoesOrAnotherTakesOver) {
  leads(1);
  say(1, R"({"hand": {"sequence": "1", "position_mm": [1, 2, 3], "held": true}})");
  leads(2, "TAKE_OVER");
  ASSERT_EQ(played.cursors.size(), 2u);
  EXPECT_FALSE(played.cursors[1].held());
  EXPECT_EQ(played.cursors[1].position_mm(0), 1.0) << "where it is";
  say(2, R"({"hand": {"sequence": "1", "position_mm": [7, 0, 0], "held": true}})");
  desk.closed(2, now);
  ASSERT_EQ(played.cursors.size(), 4u);
  EXPECT_FALSE(played.cursors[3].held());
  EXPECT_EQ(desk.leader(), 0u);
  EXPECT_EQ(hello(1).leader(), 0u);
}

TEST_F(PageDeskTest, WhatAPageWaitsForIsWithdrawnWhenItGoes) {
  leads(1);
  say(1, R"({"request": {"id": 4, "order": {"engage": true}}})");
  const std::uint64_t engage = played.orders.back().first;
  desk.closed(1, now);
  EXPECT_THAT(played.withdrawn, ::testing::Contains(engage));
  desk.answered(engage, pb::Reply(), now);  // nobody is there to hear
  EXPECT_EQ(desk.pages(), 1u);
}

TEST_F(PageDeskTest, TheLeaderLearnsOnceThatItsCursorIsNotTaken) {
  leads(1);
  pb::Reply no;
  no.set_done(false);
  no.set_reason("cursor: the device is 'Phantom Omni'");
  const std::size_t before = played.frames[1].size();
  desk.pointed(no);
  desk.pointed(no);
  ASSERT_EQ(played.frames[1].size(), before + 1);
  EXPECT_EQ(played.frames[1].back().hand().reason(), "cursor: the device is 'Phantom Omni'");
  pb::Reply yes;
  yes.set_done(true);
  desk.pointed(yes);
  EXPECT_TRUE(played.frames[1].back().hand().taken());
}

TEST_F(PageDeskTest, APageThatComesLaterGetsTheScene) {
  pb::SceneNews scene;
  scene.set_name("gearshift");
  desk.scene(scene);
  EXPECT_EQ(played.frames[1].back().scene().name(), "gearshift");
  desk.opened(3, false, now);
  EXPECT_EQ(played.frames[3].back().scene().name(), "gearshift");
  EXPECT_TRUE(played.frames[3].front().has_hello()) << "the first frame";
}

TEST_F(PageDeskTest, EndsAPageThatSaysWhatNobodyUnderstands) {
  const char* bad[] = {"",           "{",
                       "[]",         "null",
                       "{\"x\": 1}", R"({"request": {"id": -1}})",
                       "{}",         R"({"hand": {"position_mm": "x"}})"};
  PageId page = 10;
  for (const char* text : bad) {
    desk.opened(++page, false, now);
    say(page, text);
    EXPECT_THAT(played.ended[page], HasSubstr("1008 ")) << text;
  }
}

TEST_F(PageDeskTest, EndsAPageThatFloodsIt) {
  const std::string frame = R"({"hand": {"sequence": "1"}})";
  for (int i = 0; i < PageDesk::kMostFrames; ++i) say(1, frame);
  EXPECT_EQ(played.ended.count(1), 0u);
  say(1, frame);
  EXPECT_THAT(played.ended[1], HasSubstr("500 frames in a second"));
  now += kSecond;
  played.ended.clear();
  say(1, frame);
  EXPECT_EQ(played.ended.count(1), 0u) << "another second";
}

TEST_F(PageDeskTest, SpeaksInItsOwnNameAndTakesNoStatusAndNoCursorAsOrders) {
  leads(1);
  const std::size_t before = played.orders.size();
  say(1, R"({"request": {"id": 1, "order": {"engage": true, "as": "ann"}}})");
  EXPECT_THAT(reply(1), HasSubstr("1 refused: as:"));
  say(1, R"({"request": {"id": 2, "order": {"status": true}}})");
  EXPECT_THAT(reply(1), HasSubstr("2 refused"));
  say(1, R"({"request": {"id": 3, "order": {"cursor": {"held": true}}}})");
  EXPECT_THAT(reply(1), HasSubstr("3 refused"));
  say(1, R"({"request": {"id": 4}})");
  EXPECT_THAT(reply(1), HasSubstr("4 refused: the request holds no order"));
  EXPECT_EQ(played.orders.size(), before);
}

class ObserverDeskTest : public PageDeskTest {
 protected:
  ObserverDeskTest() : PageDeskTest(true) {}
};

TEST_F(ObserverDeskTest, NothingPassesAStopNeither) {
  EXPECT_EQ(hello(1).role(), pb::Hello::OBSERVER);
  say(1, R"({"lead": {"id": 1}})");
  EXPECT_THAT(reply(1), HasSubstr("1 refused: this console only looks"));
  say(1, R"({"request": {"id": 2, "order": {"stop": true}}})");
  EXPECT_THAT(reply(1), HasSubstr("2 refused: this console only looks"));
  say(1, R"({"hand": {"sequence": "1", "position_mm": [0, 0, 0], "held": true}})");
  EXPECT_THAT(played.orders, IsEmpty());
  EXPECT_THAT(played.cursors, IsEmpty());
}

TEST_F(PageDeskTest, APageOfAnObserversLinkLooksOnWhileOthersDrive) {
  desk.opened(3, true, now);
  EXPECT_EQ(hello(3).role(), pb::Hello::OBSERVER);
  EXPECT_EQ(hello(1).role(), pb::Hello::OPERATOR);
  leads(1);
  EXPECT_EQ(hello(3).role(), pb::Hello::OBSERVER) << "told again when another leads";
  const std::size_t before = played.orders.size();
  for (const char* act : {"TAKE", "TAKE_OVER", "RELEASE"}) {
    say(3, R"({"lead": {"id": 4, "act": ")" + std::string(act) + "\"}}");
    EXPECT_THAT(reply(3), HasSubstr("4 refused: this page only looks")) << act;
  }
  for (const char* order : {R"({"stop": true})", R"({"engage": true})", R"({"status": true})"}) {
    say(3, R"({"request": {"id": 5, "order": )" + std::string(order) + "}}");
    EXPECT_THAT(reply(3), HasSubstr("5 refused: this page only looks")) << order;
  }
  say(3, R"({"hand": {"sequence": "1", "position_mm": [0, 0, 0], "held": true}})");
  EXPECT_EQ(played.orders.size(), before);
  EXPECT_THAT(played.cursors, IsEmpty());
  EXPECT_EQ(desk.leader(), 1u);
}

}  // namespace
}  // namespace handrail
