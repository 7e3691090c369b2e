// A desk that shows a recording: what pages are told, and that no order of theirs goes anywhere.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>

#include <map>
#include <vector>

#include "client/console/gateway/page_desk.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class RecordingPages : public PageSink, public PlayOrders {
 public:
  void send(PageId page, SharedText frame, bool, FrameWorth) override {
    pb::ToPage read;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(*frame, &read).ok()) << *frame;
    frames[page].push_back(read);
  }
  void end(PageId page, std::uint16_t, const std::string& why) override { ended[page] = why; }
  Result<PlayState> play(const PlayOrder& order) override {
    orders.push_back(order);
    if (order.speed && *order.speed > 10.0) return Status::error("speed: too fast");
    return PlayState{};
  }
  std::map<PageId, std::vector<pb::ToPage>> frames;
  std::map<PageId, std::string> ended;
  std::vector<PlayOrder> orders;
};

class RecordingDeskTest : public ::testing::Test {
 protected:
  RecordingDeskTest() {
    desk.opened(1, false, 0);
    desk.opened(2, true, 0);
  }
  static PlayedRecording recording(PlayOrders& orders) {
    PlayedRecording out;
    out.news.set_file("/rec/a.mcap");
    out.news.set_length_s(62.5);
    out.orders = &orders;
    return out;
  }
  // The reply to that frame.
  std::string said(PageId page, const std::string& json) {
    const std::size_t before = pages.frames[page].size();
    desk.received(page, json, kSecond);
    EXPECT_EQ(pages.frames[page].size(), before + 1) << json;
    const pb::PageReply& reply = pages.frames[page].back().reply();
    return std::to_string(reply.id()) + (reply.done() ? " done" : " refused: ") + reply.reason();
  }
  RecordingPages pages;
  PageDesk desk{pages, recording(pages), {false, "1.2", "", "/rec/a.mcap", {}}};
};

TEST_F(RecordingDeskTest, TellsEachPageThatItIsOne) {
  for (const PageId page : {1u, 2u}) {
    const pb::Hello& hello = pages.frames[page].at(0).hello();
    EXPECT_EQ(hello.role(), pb::Hello::OBSERVER);
    EXPECT_EQ(hello.recording().file(), "/rec/a.mcap");
    EXPECT_EQ(hello.recording().length_s(), 62.5);
    EXPECT_EQ(hello.leader(), 0u);
  }
}

TEST_F(RecordingDeskTest, NoOrderPassesNorALeadNorAStop) {
  const std::vector<std::string> orders = {
      R"({"request": {"id": 3, "order": {"engage": true}}})",
      R"({"request": {"id": 3, "order": {"stop": true}}})",
      R"({"request": {"id": 3, "order": {"scene_load": "gearshift"}}})",
      R"({"lead": {"id": 3, "act": "TAKE"}})",
      R"({"lead": {"id": 3, "act": "TAKE_OVER"}})",
      R"({"lead": {"id": 3, "act": "RELEASE"}})"};
  for (const std::string& order : orders) {
    for (const PageId page : {1u, 2u}) {
      EXPECT_THAT(said(page, order), HasSubstr("3 refused: this is a recording: no order"));
    }
  }
  const std::size_t before = pages.frames[1].size();
  desk.received(1, R"({"hand": {"sequence": "1", "position_mm": [0, 0, 0], "held": true}})", 0);
  EXPECT_EQ(pages.frames[1].size(), before);
  EXPECT_EQ(desk.leader(), 0u);
  EXPECT_TRUE(pages.orders.empty());
  desk.closed(1, 0);
  desk.closed(2, 0);
}

TEST_F(RecordingDeskTest, APagePlaysAndOneThatOnlyLooksDoesNot) {
  EXPECT_EQ(said(1, R"({"play": {"id": 4, "playing": true, "position_s": 1.5, "speed": 2}})"),
            "4 done");
  ASSERT_EQ(pages.orders.size(), 1u);
  EXPECT_EQ(pages.orders[0].playing, true);
  EXPECT_EQ(pages.orders[0].position, 1'500'000'000);
  EXPECT_EQ(pages.orders[0].speed, 2.0);
  EXPECT_EQ(said(1, R"({"play": {"id": 5, "playing": false}})"), "5 done");
  EXPECT_FALSE(pages.orders[1].position || pages.orders[1].speed);
  EXPECT_EQ(said(1, R"({"play": {"id": 6, "speed": 11}})"), "6 refused: speed: too fast");
  for (const char* at : {"\"NaN\"", "\"Infinity\"", "1e300", "-1e10"}) {
    EXPECT_THAT(said(1, std::string(R"({"play": {"id": 7, "position_s": )") + at + "}}"),
                HasSubstr("expected seconds of the recording"));
  }
  EXPECT_THAT(said(2, R"({"play": {"id": 8, "playing": true}})"),
              HasSubstr("8 refused: this page only looks"));
  EXPECT_EQ(pages.orders.size(), 3u);
}

TEST_F(RecordingDeskTest, AStatusSaysWhichMomentItIsOf) {
  pb::Reply reply;
  reply.set_done(true);
  reply.mutable_status()->set_state("engaged");
  desk.played({PlayState::Is::kEnded, 2'500 * kMillisecond, 0.5, 7, 9});
  desk.status(reply, 0, 0);
  const pb::StatusNews& news = pages.frames[2].back().status();
  EXPECT_EQ(news.status().state(), "engaged");
  EXPECT_EQ(news.play().state(), pb::PlayNews::ENDED);
  EXPECT_EQ(news.play().position_s(), 2.5);
  EXPECT_EQ(news.play().speed(), 0.5);
  EXPECT_EQ(news.play().jumps(), 7u);
}

// A live desk has no player.
class NoMaster : public MasterOrders {
 public:
  void order(std::uint64_t, const pb::Request&) override {}
  void withdraw(std::uint64_t) override {}
  void point(const pb::CursorOrder&) override {}
};

TEST(LiveDesk, HasNothingToPlay) {
  RecordingPages pages;
  NoMaster master;
  PageDesk desk(pages, master, {false, "1.2", "", "", {}});
  desk.opened(1, false, 0);
  EXPECT_FALSE(pages.frames[1].at(0).hello().has_recording());
  desk.received(1, R"({"play": {"id": 8, "playing": true}})", 0);
  EXPECT_THAT(pages.frames[1].back().reply().reason(), HasSubstr("this is no recording"));
  desk.status(Status::error("away"), 0, 0);
  EXPECT_FALSE(pages.frames[1].back().status().has_play());
}

}  // namespace
}  // namespace handrail
