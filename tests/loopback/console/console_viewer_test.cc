// Viewers at a real console: their times and bounds are those of pages.
#include <gmock/gmock.h>

#include "tests/loopback/console/console_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class ConsoleViewerTest : public ConsoleCell {
 protected:
  void SetUp() override {
    WholeCell::SetUp();
    start_console();
    const std::string address = console->after("VIEWERS ");
    target = address.substr(address.find("/foxglove"));
  }
  WebPage::Asks viewer_asks(const std::string& protocol = "foxglove.sdk.v1") const {
    return {host(), "", "", protocol, target};
  }
  std::unique_ptr<WebPage> open_viewer() {
    auto out = std::make_unique<WebPage>();
    EXPECT_EQ(out->open(port, viewer_asks()), "");
    return out;
  }
  // All ten channels.
  static void look_at_all(WebPage& viewer) {
    std::string all;
    for (int i = 1; i <= 10; ++i) {
      all += (i > 1 ? ", " : "") + std::string("{\"id\": ") + std::to_string(i) +
             ", \"channelId\": " + std::to_string(i) + "}";
    }
    EXPECT_TRUE(viewer.say(R"({"op": "subscribe", "subscriptions": [)" + all + "]}"));
  }
  std::string target;
};

TEST_F(ConsoleViewerTest, AViewerIsToldTheChannelsAndGetsWhatItAsksFor) {
  const auto viewer = open_viewer();
  EXPECT_EQ(viewer->protocol(), "foxglove.sdk.v1");
  EXPECT_THAT(viewer->next(kPatience).value_or(""), HasSubstr(R"("op":"serverInfo")"));
  EXPECT_THAT(viewer->next(kPatience).value_or(""), HasSubstr(R"("op":"advertise")"));
  viewer->say(R"({"op": "subscribe", "subscriptions": [{"id": 513, "channelId": 10}]})");
  const auto frame = viewer->next(kPatience);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->substr(0, 5), std::string("\x01\x01\x02\x00\x00", 5));
  pb::Status read;
  ASSERT_TRUE(read.ParseFromString(frame->substr(13)));
  EXPECT_EQ(read.scene(), "linear-movement");
}

TEST_F(ConsoleViewerTest, AnotherProtocolAndAnotherSecretAreRefused) {
  EXPECT_EQ(WebPage().open(port, viewer_asks("foxglove.websocket.v2")), "400");
  EXPECT_EQ(WebPage().open(port, viewer_asks("handrail.console.v1")), "400");
  WebPage old;
  EXPECT_EQ(old.open(port, viewer_asks("foxglove.websocket.v1")), "");
  EXPECT_EQ(old.protocol(), "foxglove.websocket.v1");
  WebPage both;
  EXPECT_EQ(both.open(port, viewer_asks("foxglove.websocket.v1, foxglove.sdk.v1")), "");
  EXPECT_EQ(both.protocol(), "foxglove.sdk.v1") << "preferred wherever it stands";
  WebPage::Asks asks = viewer_asks();
  asks.target = "/foxglove?key=0123456789abcdef0123456789abcdef";
  EXPECT_EQ(WebPage().open(port, asks), "403");
  EXPECT_EQ(web_get(port, target, host_header()).status, 403u) << "it is no file";
}

TEST_F(ConsoleViewerTest, OneThatReadsNothingIsLetGoAndMoreThanSixteenAreToldSo) {
  const auto page = open_page();
  WebPage slow;
  ASSERT_EQ(slow.open(port, viewer_asks()), "");
  beast::get_lowest_layer(slow.socket())
      .socket()
      .set_option(boost::asio::socket_base::receive_buffer_size(4096));
  look_at_all(slow);
  const Nanos begin = monotonic_now();
  std::vector<std::unique_ptr<WebPage>> viewers;
  for (int i = 1; i < 16; ++i) viewers.push_back(open_viewer());
  EXPECT_EQ(WebPage().open(port, viewer_asks()), "503");
  EXPECT_EQ(WebPage().open(port, own_asks()), "") << "viewers take no page's place";
  Nanos longest = 0, last = monotonic_now();
  bool gone = false;
  while (!gone && monotonic_now() - begin < 20 * kSecond) {
    const auto frame = page->next_frame(kSecond);
    ASSERT_TRUE(frame);
    longest = std::max(longest, monotonic_now() - last);
    last = monotonic_now();
    // Fast enough to see it, seldom enough to be no load.
    if (frame->status().number() % 30 == 0) gone = WebPage().open(port, viewer_asks()).empty();
  }
  EXPECT_TRUE(gone) << "and before its silence alone would have";
  EXPECT_LT(longest, 500 * kMillisecond);
}

TEST_F(ConsoleViewerTest, WhatIsTooLongOrTooMuchEndsItsViewerAlone) {
  const auto page = open_page();
  const auto too_long = open_viewer(), flood = open_viewer(), well = open_viewer();
  too_long->say(std::string(70'000, ' '));
  while (too_long->next(kSecond)) {
  }
  EXPECT_EQ(too_long->close_code(), 1009);
  for (int i = 0; i < 200; ++i) flood->say("{");
  while (flood->next(kSecond)) {
  }
  EXPECT_EQ(flood->close_code(), 1008);
  look_at_all(*well);
  EXPECT_TRUE(well->next(kPatience));
  EXPECT_TRUE(page->next_frame(kPatience));
}

}  // namespace
}  // namespace handrail
