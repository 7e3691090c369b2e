// Foxglove's bar of time: its bytes as the SDK's sources have them, and what becomes of them.
#include <gmock/gmock.h>

#include <map>
#include <vector>

#include "client/console/viewer/viewer_desk.h"

namespace handrail {
namespace {

using namespace std::string_literals;
using ::testing::HasSubstr;

constexpr Nanos kBegin = 1'700'000'000 * kSecond + 5, kEnd = kBegin + 60 * kSecond;

// From the tests of the SDK: play at 1.5, seeks to 100.5 s, "some-id".
const std::string kPlayWithSeek =
    "\x03\x00\x00\x00\xc0\x3f\x01\x00\x4d\x44\x66\x17\x00\x00\x00\x07\x00\x00\x00some-id"s;

TEST(ViewerPlay, ARequestIsReadAsTheSdkWritesIt) {
  const auto play = viewer_play(kPlayWithSeek);
  ASSERT_TRUE(play) << play.message();
  EXPECT_TRUE(play->playing);
  EXPECT_EQ(play->speed, 1.5f);
  EXPECT_EQ(play->seek, 100'500'000'000);
  EXPECT_EQ(play->id, "some-id");
  std::string pause = kPlayWithSeek;
  pause[1] = 1;
  pause[6] = 0;
  EXPECT_FALSE(viewer_play(pause)->playing);
  EXPECT_FALSE(viewer_play(pause)->seek) << "the time that stands there is none";
}

TEST(ViewerPlay, WhatIsNoRequestSaysWhy) {
  for (std::size_t cut = 0; cut < kPlayWithSeek.size(); ++cut) {
    EXPECT_FALSE(viewer_play(kPlayWithSeek.substr(0, cut))) << cut;
  }
  const auto changed = [](std::size_t at, const std::string& bytes) {
    std::string frame = kPlayWithSeek;
    frame.replace(at, bytes.size(), bytes);
    const auto play = viewer_play(frame);
    return play ? "taken" : play.message();
  };
  EXPECT_THAT(changed(0, "\x01"), HasSubstr("opcode 1, expected 3"));
  EXPECT_THAT(changed(1, "\x02"), HasSubstr("command 2, expected 0, play, or 1, pause"));
  EXPECT_THAT(changed(2, "\xff\xff\xff\xff"), HasSubstr("speed: expected a number"));
  EXPECT_THAT(changed(2, "\x00\x00\x80\x7f"s), HasSubstr("speed: expected a number"));
  EXPECT_THAT(changed(15, "\xff\xff\xff\xff"), HasSubstr("not whole"));
  EXPECT_THAT(changed(19, "\xff"), HasSubstr("request id: expected text"));
}

TEST(ViewerPlay, AStateIsWrittenAsTheSdkReadsIt) {
  EXPECT_EQ(playback_frame({PlayState::Is::kPlaying, 0, 1.0, 0, 0}, 12345, false, ""),
            "\x05\x00\x39\x30\x00\x00\x00\x00\x00\x00\x00\x00\x80\x3f\x00\x00\x00\x00\x00"s);
  EXPECT_EQ(playback_frame({PlayState::Is::kEnded, 0, 0.5, 0, 0}, 12345, true, "i-am"),
            "\x05\x03\x39\x30\x00\x00\x00\x00\x00\x00\x00\x00\x00\x3f\x01\x04\x00\x00\x00i-am"s);
  EXPECT_EQ(playback_frame({PlayState::Is::kPaused, 0, 1.0, 0, 0}, 0, false, "").substr(0, 2),
            "\x05\x01"s);
  EXPECT_EQ(time_frame(0x1122334455667788), "\x02\x88\x77\x66\x55\x44\x33\x22\x11"s);
}

TEST(ViewerPlay, TheServerSaysFromWhenToWhenAndWhatItTakes) {
  EXPECT_EQ(server_info_text("1.2", "77", ViewerRange{kBegin, kEnd}),
            R"({"op":"serverInfo","name":"handrail-console 1.2, a recording",)"
            R"("capabilities":["time","playbackControl"],"sessionId":"77",)"
            R"("dataStartTime":{"sec":1700000000,"nsec":5},)"
            R"("dataEndTime":{"sec":1700000060,"nsec":5}})");
}

class PlayingViewers : public PageSink, public PlayOrders {
 public:
  void send(PageId page, SharedText frame, bool binary, FrameWorth) override {
    (binary ? bytes : texts)[page].push_back(*frame);
  }
  void end(PageId, std::uint16_t, const std::string&) override {}
  Result<PlayState> play(const PlayOrder& order) override {
    orders.push_back(order);
    ++now.orders;
    now.jumps += order.position ? 1 : 0;
    if (order.position) now.position = *order.position;
    if (order.speed) now.speed = *order.speed;
    now.is = order.playing.value_or(false) ? PlayState::Is::kPlaying : PlayState::Is::kPaused;
    return now;
  }
  // Frames of an opcode.
  std::vector<std::string> of(PageId page, char opcode) const {
    std::vector<std::string> out;
    for (const std::string& each : bytes.at(page)) {
      if (each[0] == opcode) out.push_back(each);
    }
    return out;
  }
  std::map<PageId, std::vector<std::string>> bytes, texts;
  std::vector<PlayOrder> orders;
  PlayState now;
};

class ViewerPlayDesk : public ::testing::Test {
 protected:
  ViewerPlayDesk() {
    desk.show_recording({kBegin, kEnd}, viewers);
    for (const PageId page : {1u, 2u}) desk.opened(page, 0);
    reply.set_done(true);
    reply.mutable_status()->set_state("off");
  }
  void ask(PageId page, const std::string& frame) { desk.received(page, frame, true, {0, 99}); }
  PlayingViewers viewers;
  ViewerDesk desk{viewers, "1.2", "77"};
  pb::Reply reply;
};

TEST_F(ViewerPlayDesk, OneThatComesIsToldWhereThePlayerStands) {
  ASSERT_EQ(viewers.of(1, 5).size(), 1u);
  EXPECT_EQ(viewers.of(1, 5)[0], playback_frame({}, kBegin, false, ""));
  EXPECT_THAT(viewers.texts[1].at(0), HasSubstr("playbackControl"));
}

TEST_F(ViewerPlayDesk, ARequestIsAnsweredToWhoAskedAndSaidToAll) {
  std::string frame = kPlayWithSeek;
  for (std::size_t i = 0; i < 8; ++i) {
    frame[7 + i] = static_cast<char>((kBegin + 10 * kSecond) >> (8 * i));
  }
  ask(1, frame);
  ASSERT_EQ(viewers.orders.size(), 1u);
  EXPECT_EQ(viewers.orders[0].playing, true);
  EXPECT_EQ(viewers.orders[0].speed, 1.5);
  EXPECT_EQ(viewers.orders[0].position, 10 * kSecond);
  const PlayState state{PlayState::Is::kPlaying, 10 * kSecond, 1.5, 1, 1};
  EXPECT_EQ(viewers.of(1, 5).back(), playback_frame(state, kBegin + 10 * kSecond, true, "some-id"));
  EXPECT_EQ(viewers.of(2, 5).back(), playback_frame(state, kBegin + 10 * kSecond, true, ""));
  // The state that comes by itself says nothing new, and one from before the order nothing at all.
  EXPECT_FALSE(desk.played({PlayState::Is::kPaused, 0, 1.0, 0, 0}));
  EXPECT_TRUE(desk.played(state));
  EXPECT_EQ(viewers.of(1, 5).size(), 2u);
  EXPECT_EQ(viewers.of(1, 2).back(), time_frame(kBegin + 10 * kSecond));
  EXPECT_TRUE(desk.played({PlayState::Is::kEnded, 60 * kSecond, 1.5, 1, 1}));
  EXPECT_EQ(viewers.of(2, 5).size(), 3u) << "the end is said";
}

TEST_F(ViewerPlayDesk, SpeedsBeyondOursAreTheNearest) {
  std::string slow = kPlayWithSeek, fast = kPlayWithSeek;
  slow.replace(2, 4, "\x0a\xd7\x23\x3c");   // 0.01
  fast.replace(2, 4, "\x00\x00\xc8\x42"s);  // 100
  ask(1, slow);
  ask(1, fast);
  EXPECT_EQ(viewers.orders.at(0).speed, 0.1);
  EXPECT_EQ(viewers.orders.at(1).speed, 10.0);
  EXPECT_TRUE(viewers.texts[1].size() == 2) << "no error";
  ask(1, "\x01");
  EXPECT_THAT(viewers.texts[1].back(), HasSubstr("opcode 1, expected 3"));
  EXPECT_EQ(viewers.orders.size(), 2u);
}

TEST_F(ViewerPlayDesk, MessagesHaveTheTimeOfTheRecordingAndWhatStaysIsSaidAgainAfterASeek) {
  const auto subscribe = [&](int id, int channel) {
    desk.received(1,
                  R"({"op": "subscribe", "subscriptions": [{"id": )" + std::to_string(id) +
                      R"(, "channelId": )" + std::to_string(channel) + "}]}",
                  false, {0, 99});
  };
  subscribe(7, 5);   // /cell
  subscribe(8, 10);  // /status
  subscribe(9, 9);   // /events
  const auto times = [&](char id) {
    std::vector<Nanos> out;
    for (const std::string& frame : viewers.of(1, 1)) {
      if (frame[1] != id) continue;
      Nanos time = 0;
      for (int i = 0; i < 8; ++i) {
        time |=
            static_cast<Nanos>(static_cast<unsigned char>(frame[static_cast<std::size_t>(5 + i)]))
            << (8 * i);
      }
      out.push_back(time);
    }
    return out;
  };
  EXPECT_EQ(times(7), std::vector<Nanos>{kBegin}) << "and not that of the calendar";
  desk.scene({}, {}, 99);
  EXPECT_EQ(times(7).size(), 2u);
  desk.played({PlayState::Is::kPaused, kSecond, 1.0, 0, 0});
  desk.status(reply, 99);
  EXPECT_EQ(times(8), std::vector<Nanos>{kBegin + kSecond});
  reply.mutable_status()->set_state("fault");
  desk.played({PlayState::Is::kPaused, 40 * kSecond, 1.0, 1, 1});
  desk.status(reply, 99);
  EXPECT_EQ(times(7).back(), kBegin + 40 * kSecond);
  EXPECT_EQ(times(7).size(), 3u);
  EXPECT_TRUE(times(9).empty()) << "no event happens between two moments that one jumps over";
  reply.mutable_status()->set_state("off");
  desk.played({PlayState::Is::kPlaying, 41 * kSecond, 1.0, 1, 2});
  desk.status(reply, 99);
  EXPECT_EQ(times(9).size(), 1u) << "but while it plays";
}

}  // namespace
}  // namespace handrail
