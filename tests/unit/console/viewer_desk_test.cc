// Who looks at which channel, with viewers that the test plays.
#include "client/console/viewer/viewer_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handrail {
namespace {

using namespace std::string_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Channels as they are advertised.
constexpr std::uint32_t kTf = 1, kTipPose = 3, kCell = 5, kMarks = 6, kMap = 7, kLog = 8;
constexpr std::uint32_t kEvents = 9, kStatusChannel = 10;

struct Sent {
  SharedText frame;
  bool binary;
  FrameWorth worth;
  std::uint32_t id() const { return static_cast<unsigned char>((*frame)[1]); }  // below 256
  std::string message() const { return frame->substr(13); }
};

class PlayedViewers : public PageSink {
 public:
  void send(PageId page, SharedText frame, bool binary, FrameWorth worth) override {
    sent[page].push_back({std::move(frame), binary, worth});
  }
  void end(PageId page, std::uint16_t code, const std::string& why) override {
    ended[page] = std::to_string(code) + " " + why;
  }
  std::map<PageId, std::vector<Sent>> sent;
  std::map<PageId, std::string> ended;
};

class ViewerDeskTest : public ::testing::Test {
 protected:
  ViewerDeskTest() {
    desk.opened(1, at.now);
    desk.opened(2, at.now);
    reply.set_done(true);
    pb::Status& s = *reply.mutable_status();
    s.set_state("off");
    s.set_reason("none");
    for (const double v : {1.0, 2.0, 3.0}) s.mutable_tip()->add_position_mm(v);
    for (const double v : {1.0, 0.0, 0.0, 0.0}) s.mutable_tip()->add_quaternion(v);
    scene.mutable_arm()->set_tip_mm(301);
  }
  void say(PageId viewer, const std::string& json) { desk.received(viewer, json, false, at); }
  void subscribe(PageId viewer, std::uint32_t id, std::uint32_t channel) {
    say(viewer, R"({"op": "subscribe", "subscriptions": [{"id": )" + std::to_string(id) +
                    R"(, "channelId": )" + std::to_string(channel) + "}]}");
  }
  void tell() { desk.status(reply, at.calendar); }
  std::vector<Sent> data(PageId viewer) const {
    std::vector<Sent> out;
    for (const Sent& each : played.sent.at(viewer)) {
      if (each.binary) out.push_back(each);
    }
    return out;
  }
  std::string last_text(PageId viewer) const {
    std::string out;
    for (const Sent& each : played.sent.at(viewer)) {
      if (!each.binary) out = *each.frame;
    }
    return out;
  }
  std::vector<pb::ViewerEvent::Kind> kinds(PageId viewer) const {
    std::vector<pb::ViewerEvent::Kind> out;
    for (const Sent& each : data(viewer)) {
      pb::ViewerEvent event;
      EXPECT_TRUE(event.ParseFromString(each.message()));
      out.push_back(event.kind());
    }
    return out;
  }

  PlayedViewers played;
  ViewerDesk desk{played, "1.2", "77"};
  Moment at{100 * kSecond, 1'700'000'000 * kSecond + 5};
  pb::Reply reply;
  pb::SceneNews scene;
};

TEST_F(ViewerDeskTest, OneThatComesIsToldWhoThisIsAndWhichChannelsThereAre) {
  ASSERT_THAT(played.sent[1], SizeIs(2));
  EXPECT_THAT(*played.sent[1][0].frame, HasSubstr(R"("op":"serverInfo")"));
  EXPECT_THAT(*played.sent[1][1].frame, HasSubstr(R"("op":"advertise")"));
  for (const char* topic : {"/tf", "/joints", "/tip", "/tip/desired", "/cell", "/marks", "/map",
                            "/log", "/events", "/status"}) {
    EXPECT_THAT(*played.sent[1][1].frame, HasSubstr(std::string("\"") + topic + "\""));
  }
}

TEST_F(ViewerDeskTest, NothingIsEncodedForChannelsThatNobodyLooksAt) {
  desk.scene(scene, {}, at.calendar);
  for (int i = 0; i < 100; ++i) tell();
  EXPECT_EQ(desk.encoded(), 0u);
  EXPECT_THAT(data(1), IsEmpty());
  subscribe(1, 7, kTipPose);
  tell();
  EXPECT_EQ(desk.encoded(), 1u);
  ASSERT_THAT(data(1), SizeIs(1));
  EXPECT_THAT(data(2), IsEmpty());
}

TEST_F(ViewerDeskTest, AMessageIsEncodedOnceForAllAndCarriesEachOnesId) {
  subscribe(1, 7, kStatusChannel);
  subscribe(2, 9, kStatusChannel);
  desk.opened(3, at.now);
  subscribe(3, 9, kStatusChannel);
  tell();
  EXPECT_EQ(desk.encoded(), 1u);
  EXPECT_EQ(data(1).at(0).id(), 7u);
  EXPECT_EQ(data(2).at(0).id(), 9u);
  EXPECT_EQ(data(2).at(0).frame, data(3).at(0).frame) << "the same bytes are shared";
  pb::Status read;
  ASSERT_TRUE(read.ParseFromString(data(1).at(0).message()));
  EXPECT_EQ(read.state(), "off");
  // Nanoseconds, little-endian: 1 700 000 000 000 000 005.
  EXPECT_EQ(data(1).at(0).frame->substr(5, 8), "\x05\x00\x2a\x36\xfe\x9c\x97\x17"s);
}

TEST_F(ViewerDeskTest, OfDataOnlyTheNewestWaitsAndOfLinesAndEventsMany) {
  for (const std::uint32_t channel : {kTf, kMarks, kLog, kEvents, kStatusChannel}) {
    subscribe(1, channel, channel);
  }
  tell();
  reply.mutable_status()->set_state("fault");
  tell();
  std::map<std::uint32_t, std::size_t> most;
  std::map<int, std::uint32_t> channel_of_slot;
  for (const Sent& each : data(1)) {
    most[each.id()] = each.worth.most;
    EXPECT_GE(each.worth.slot, 0);
    EXPECT_EQ(channel_of_slot.emplace(each.worth.slot, each.id()).first->second, each.id())
        << "a slot is a channel's own";
  }
  EXPECT_EQ(most[kTf], 1u);
  EXPECT_EQ(most[kStatusChannel], 1u);
  EXPECT_EQ(most[kLog], ViewerDesk::kMostWait);
  EXPECT_EQ(most[kEvents], ViewerDesk::kMostWait);
}

TEST_F(ViewerDeskTest, WhatIsUnsubscribedComesNoMore) {
  subscribe(1, 7, kTipPose);
  tell();
  say(1, R"({"op": "unsubscribe", "subscriptionIds": [7]})");
  tell();
  EXPECT_THAT(data(1), SizeIs(1));
  say(1, R"({"op": "unsubscribe", "subscriptionIds": [7]})");
  EXPECT_THAT(last_text(1), HasSubstr("subscription 7 is not known"));
  subscribe(1, 7, kTipPose);
  tell();
  EXPECT_THAT(data(1), SizeIs(2)) << "the id is free again";
}

TEST_F(ViewerDeskTest, WhatStandsStillComesOnceToEachAndAgainWithAnotherScene) {
  desk.scene(scene, {}, at.calendar);
  subscribe(1, 7, kCell);
  tell();
  tell();
  EXPECT_THAT(data(1), SizeIs(1));
  subscribe(2, 8, kCell);
  EXPECT_THAT(data(1), SizeIs(1)) << "the first has it already";
  EXPECT_THAT(data(2), SizeIs(1));
  desk.scene(scene, {}, at.calendar);
  EXPECT_THAT(data(1), SizeIs(2));
  EXPECT_THAT(data(2), SizeIs(2));
  EXPECT_EQ(desk.encoded(), 3u);
}

TEST_F(ViewerDeskTest, TheLogHasALineWhenTheReasonChangesAndOneForWhoComes) {
  subscribe(1, 7, kLog);
  for (int i = 0; i < 5; ++i) tell();
  EXPECT_THAT(data(1), SizeIs(1));
  subscribe(2, 7, kLog);
  tell();
  EXPECT_THAT(data(1), SizeIs(1));
  EXPECT_THAT(data(2), SizeIs(1));
  reply.mutable_status()->set_reason("joint range");
  tell();
  EXPECT_THAT(data(1), SizeIs(2));
  desk.status(Status::error("no master: start handrail-master"), at.calendar);
  foxglove::Log line;
  ASSERT_TRUE(line.ParseFromString(data(2).back().message()));
  EXPECT_EQ(line.message(), "no master: start handrail-master");
  EXPECT_EQ(line.level(), foxglove::Log::ERROR);
}

TEST_F(ViewerDeskTest, EventsTellOfChangesAndNotOfWhatWasBefore) {
  subscribe(1, 7, kEvents);
  tell();
  EXPECT_THAT(kinds(1), IsEmpty());
  pb::Status& s = *reply.mutable_status();
  s.set_state("engaged");
  s.mutable_lease()->set_holder("ann");
  tell();
  tell();
  EXPECT_THAT(kinds(1), ElementsAre(pb::ViewerEvent::STATE, pb::ViewerEvent::LEASE));
  s.set_state("fault");
  s.set_reason("stop was requested: reset, then engage again");
  tell();
  s.set_reason("the stop circuit is open");
  tell();
  desk.status(Status::error("gone"), at.calendar);
  EXPECT_THAT(kinds(1),
              ElementsAre(pb::ViewerEvent::STATE, pb::ViewerEvent::LEASE, pb::ViewerEvent::STOP,
                          pb::ViewerEvent::FAULT, pb::ViewerEvent::MASTER));
  desk.closed(1);
  s.set_state("off");
  desk.opened(4, at.now);
  tell();
  subscribe(4, 1, kEvents);
  tell();
  EXPECT_THAT(kinds(4), IsEmpty());
}

TEST_F(ViewerDeskTest, ASubscriptionThatCannotBeIsSaidAndNothingElseHappens) {
  subscribe(1, 7, 99);
  EXPECT_THAT(last_text(1), HasSubstr("subscription 7: there is no channel 99"));
  subscribe(1, 7, 0);
  EXPECT_THAT(last_text(1), HasSubstr("there is no channel 0"));
  subscribe(1, 7, kTipPose);
  subscribe(1, 7, kTf);
  EXPECT_THAT(last_text(1), HasSubstr("subscription 7: this id is used already"));
  subscribe(1, 8, kTipPose);
  EXPECT_THAT(last_text(1), HasSubstr("subscription 8: channel 3 is subscribed already"));
  say(1, R"({"op": "subscribe", "subscriptions": [{"id": 9}]})");
  EXPECT_THAT(last_text(1), HasSubstr("expected id and channelId"));
  EXPECT_THAT(last_text(1), HasSubstr(R"("level":2)"));
  tell();
  EXPECT_THAT(data(1), SizeIs(1));
  EXPECT_THAT(played.ended, IsEmpty());
}

TEST_F(ViewerDeskTest, WhatIsNoSubscriptionIsAnsweredAndDoesNothing) {
  for (const char* text :
       {R"({"op": "advertise", "channels": [{"id": 1, "topic": "/x"}]})",
        R"({"op": "setParameters", "parameters": [{"name": "a"}]})",
        R"({"request": {"id": 1, "order": {"engage": true}}})", "{", "", "null"}) {
    const std::size_t before = played.sent[1].size();
    say(1, text);
    EXPECT_EQ(played.sent[1].size(), before + 1) << text;
    EXPECT_THAT(last_text(1), HasSubstr(R"("op":"status","level":2)")) << text;
  }
  for (const std::string& bytes :
       {std::string(), std::string("\x01\x00\x00\x00\x00zz", 7), std::string(60000, '\xff')}) {
    desk.received(1, bytes, true, at);
    EXPECT_THAT(last_text(1), HasSubstr("a viewer only looks here"));
  }
  const std::string long_op = R"({"op": ")" + std::string(60000, 'x') + "\"}";
  say(1, long_op);
  EXPECT_LT(last_text(1).size(), 300u);
  EXPECT_EQ(desk.encoded(), 0u);
}

TEST_F(ViewerDeskTest, EndsOneThatFloodsIt) {
  for (int i = 0; i < ViewerDesk::kMostFrames; ++i) say(1, R"({"op": "unsubscribe"})");
  EXPECT_THAT(played.ended, IsEmpty());
  say(1, R"({"op": "unsubscribe"})");
  EXPECT_THAT(played.ended[1], HasSubstr("1008 more than 100 frames in a second"));
  played.ended.clear();
  at.now += kSecond;
  say(1, R"({"op": "unsubscribe"})");
  EXPECT_THAT(played.ended, IsEmpty()) << "another second";
  desk.closed(1);
  EXPECT_FALSE(desk.has(1));
  EXPECT_EQ(desk.viewers(), 1u);
}

TEST_F(ViewerDeskTest, AMapThatIsGoneIsCoveredByAClearCell) {
  MapCells cells;
  cells.columns = 2;
  cells.rows = 1;
  cells.size = Vec2(0.2, 0.1);
  cells.rgb = "abcdef";
  desk.scene(scene, cells, at.calendar);
  subscribe(1, 7, kMap);
  desk.scene(scene, {}, at.calendar);
  foxglove::Grid was, is;
  ASSERT_TRUE(was.ParseFromString(data(1).at(0).message()));
  ASSERT_TRUE(is.ParseFromString(data(1).at(1).message()));
  EXPECT_EQ(was.data(),
            "abc\xff"
            "def\xff");
  EXPECT_EQ(is.data(), std::string(4, '\0'));
}

}  // namespace
}  // namespace handrail
