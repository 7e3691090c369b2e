// The console between pages and a real cell: who is let in, what comes, who is let go.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <array>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/loopback/console/console_cell.h"

namespace handrail {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class ConsoleTest : public ConsoleCell {
 protected:
  void SetUp() override {
    WholeCell::SetUp();
    start_console();
  }
  // The gateway says that so many pages are open.
  static bool sees_pages(WebPage& page, std::uint32_t count) {
    return page
        .wait_for(kPatience, [&](const pb::ToPage& f) { return f.status().pages() == count; })
        .has_value();
  }
};

TEST_F(ConsoleTest, APageGetsTheSceneAndTheArmSixtyTimesASecond) {
  const auto page = open_page();
  EXPECT_EQ(page->protocol(), "handrail.console.v1");
  const auto first = page->next_frame(kPatience);
  ASSERT_TRUE(first && first->has_hello());
  EXPECT_EQ(first->hello().role(), pb::Hello::OPERATOR);
  EXPECT_THAT(first->hello().scene(), Contains("gearshift"));
  const auto scene = page->wait_for(kPatience, [](const pb::ToPage& f) { return f.has_scene(); });
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->scene().name(), "linear-movement");
  EXPECT_EQ(scene->scene().problem(), "");
  EXPECT_EQ(scene->scene().goal_size(), 3);
  int frames = 0;
  pb::StatusNews last;
  const Nanos begin = monotonic_now();
  while (monotonic_now() - begin < 3 * kSecond) {
    const auto frame = page->next_frame(kSecond);
    if (!frame || !frame->has_status()) continue;
    ++frames;
    last = frame->status();
  }
  EXPECT_GE(frames, 150);
  EXPECT_LE(frames, 185);
  EXPECT_EQ(last.status().joints_deg_size(), 6);
  EXPECT_EQ(last.status().joints_commanded_deg_size(), 6);
  EXPECT_LT(last.age_ms(), 50.0);
  const pb::Status direct = status();
  EXPECT_NEAR(last.status().tip().position_mm(2), direct.tip().position_mm(2), 1.0);
}

TEST_F(ConsoleTest, WhoeverDoesNotShowTheSecretIsToldNothing) {
  const std::string files[] = {"/", "/ws", "/scene/map.png",
                               "/?key=0123456789abcdef0123456789abcdef"};
  for (const std::string& file : files) {
    const WebReply answer = web_get(port, file, host_header());
    EXPECT_EQ(answer.status, 403u) << file;
    EXPECT_EQ(answer.cookie, "");
  }
  EXPECT_EQ(web_get(port, "/", own_headers()).body, "<p>page</p>");
  EXPECT_EQ(web_get(port, "/", "Host: evil.example\r\nCookie: " + cookie + "\r\n").status, 403u);
  EXPECT_EQ(web_get(port, "/", own_headers() + "Host: evil.example\r\n").status, 403u);
  EXPECT_EQ(web_get(port, "/", own_headers() + "Origin: http://evil.example\r\n").status, 403u);
  WebPage::Asks asks = own_asks();
  asks.origin = "http://evil.example";
  EXPECT_EQ(WebPage().open(port, asks), "403");
  asks = own_asks();
  asks.host = "evil.example";
  EXPECT_EQ(WebPage().open(port, asks), "403");
  asks = own_asks();
  asks.cookie = "";
  EXPECT_EQ(WebPage().open(port, asks), "403");
}

TEST_F(ConsoleTest, NoPathLeadsOutOfThePagesFolder) {
  folder.write("secret.txt", "s3cret");
  for (const char* path : {"/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
                           "//etc/passwd", "/index.html/../../secret.txt", "/..\\secret.txt"}) {
    const WebReply answer = web_get(port, path, own_headers());
    EXPECT_EQ(answer.status, 404u) << path;
    EXPECT_THAT(answer.body, Not(HasSubstr("s3cret")));
  }
  EXPECT_EQ(web_get(port, "http://evil.example/", own_headers()).status, 404u);
}

TEST_F(ConsoleTest, AWebSocketOfAnotherProtocolOrPlaceIsRefused) {
  WebPage::Asks asks = own_asks();
  asks.protocol = "chat";
  EXPECT_EQ(WebPage().open(port, asks), "400");
  asks = own_asks();
  asks.target = "/other";
  EXPECT_EQ(WebPage().open(port, asks), "404");
}

TEST_F(ConsoleTest, TwoPagesAreToldWhoLeadsAndTheMasterKnowsOneOperator) {
  const auto first = open_page(), second = open_page();
  ASSERT_TRUE(first->ask(lead("TAKE"), 1, kPatience).value().done());
  EXPECT_EQ(status().lease().holder(), "console");
  EXPECT_THAT(refusal("engage: true"), HasSubstr("console"));
  const auto other = second->ask(lead("TAKE"), 1, kPatience);
  ASSERT_TRUE(other);
  EXPECT_THAT(other->reason(), HasSubstr("TAKE_OVER"));
  EXPECT_FALSE(second->ask(request(2, R"({"engage": true})"), 2, kPatience).value().done());
  EXPECT_EQ(engage_by(*first, 3), "");
  ASSERT_TRUE(second->ask(lead("TAKE_OVER"), 1, kPatience).value().done());
  const auto told = first->wait_for(
      kPatience, [](const pb::ToPage& f) { return f.has_hello() && f.hello().leader() == 2; });
  EXPECT_TRUE(told);
  EXPECT_TRUE(second->ask(request(4, R"({"disengage": true})"), 4, kPatience).value().done());
  EXPECT_TRUE(reaches("off"));
}

TEST_F(ConsoleTest, AnObserverMayOnlyLookAndTheMasterRefusesToo) {
  console->send(SIGTERM);
  EXPECT_EQ(console->finish(), 0);
  start_console({"--observe"});
  order("engage: true");
  const auto page = open_page();
  EXPECT_THAT(page->ask(lead("TAKE"), 1, kPatience).value().reason(), HasSubstr("only looks"));
  EXPECT_FALSE(page->ask(request(2, R"({"stop": true})"), 2, kPatience).value().done());
  EXPECT_THAT(refusal("observer: true stop: true"), HasSubstr("only looks"));
  EXPECT_EQ(status().state(), "engaged");
}

TEST_F(ConsoleTest, KilledInTheMiddleOfOrdersItLeavesTheMasterWell) {
  const auto page = open_page();
  ASSERT_TRUE(page->ask(lead("TAKE"), 1, kPatience).value().done());
  ASSERT_EQ(engage_by(*page, 2), "");
  page->say(request(3, R"({"lease": {"act": "SHOW"}})"));
  console->kill();
  EXPECT_EQ(status().state(), "engaged") << "another ends what it began";
  ASSERT_TRUE(ask("as: 'console' disengage: true").done());
  const std::uint64_t before = status().ticks();
  EXPECT_TRUE(eventually([&](const pb::Status& s) { return s.ticks() > before + 500; }));
  start_console();
  EXPECT_TRUE(open_page()->ask(lead("TAKE"), 1, kPatience).value().done());
}

TEST_F(ConsoleTest, AMasterThatEndsIsMissedAndFoundAgain) {
  const auto page = open_page();
  ASSERT_TRUE(
      page->wait_for(kPatience, [](const pb::ToPage& f) { return f.status().has_status(); }));
  master->send(SIGTERM);
  master->finish();
  const auto missed = page->wait_for(kPatience, [](const pb::ToPage& f) {
    return f.status().problem().find("start handrail-master") != std::string::npos;
  });
  ASSERT_TRUE(missed);
  EXPECT_FALSE(missed->status().has_status());
  start_master();
  EXPECT_TRUE(
      page->wait_for(kPatience, [](const pb::ToPage& f) { return f.status().has_status(); }));
  EXPECT_TRUE(page->ask(lead("TAKE"), 1, kPatience).value().done());
}

TEST_F(ConsoleTest, OneThatReadsNothingIsLetGoAndDelaysNobody) {
  const auto page = open_page();
  WebPage slow;
  ASSERT_EQ(slow.open(port, own_asks()), "");
  beast::get_lowest_layer(slow.socket())
      .socket()
      .set_option(boost::asio::socket_base::receive_buffer_size(4096));
  ASSERT_TRUE(sees_pages(*page, 2));
  Nanos longest = 0, last = monotonic_now();
  const Nanos begin = last;
  while (monotonic_now() - begin < 20 * kSecond) {
    const auto frame = page->next_frame(kSecond);
    ASSERT_TRUE(frame);
    longest = std::max(longest, monotonic_now() - last);
    last = monotonic_now();
    if (frame->status().pages() == 1) break;
  }
  EXPECT_LT(last - begin, 20 * kSecond) << "let go, and before its silence alone would have";
  EXPECT_LT(longest, 500 * kMillisecond);
}

TEST_F(ConsoleTest, MorePagesThanItServesAreToldSo) {
  std::vector<std::unique_ptr<WebPage>> pages;
  for (int i = 0; i < 50; ++i) pages.push_back(open_page());
  const Nanos begin = monotonic_now();
  for (int i = 0; i < 100; ++i) EXPECT_EQ(WebPage().open(port, own_asks()), "503");
  EXPECT_LT(monotonic_now() - begin, 10 * kSecond);
  pages.pop_back();
  EXPECT_TRUE(within(kPatience, [&] { return WebPage().open(port, own_asks()).empty(); }));
}

TEST_F(ConsoleTest, MoreThanItTakesThatNeverSayWhatTheyWantKeepNobodyOut) {
  const double before = memory();
  boost::asio::io_context io;
  auto strangers = crowd(io, port, kTooMany, "GET / HTTP/1.1\r\nX: ");
  const Nanos begin = monotonic_now();
  const auto page = open_page();
  ASSERT_TRUE(page->next_frame(kPatience));
  EXPECT_LT(monotonic_now() - begin, kSecond);
  EXPECT_LT(memory() - before, 64.0) << "MiB";
  // And none of them stays.
  strangers.back().non_blocking(true);
  EXPECT_TRUE(within(kPatience, [&] {
    char byte = 0;
    beast::error_code error;
    strangers.back().read_some(boost::asio::buffer(&byte, 1), error);
    return error && error != boost::asio::error::would_block;
  }));
}

// All at once, and each says at once what it wants.
TEST_F(ConsoleTest, MoreThanItTakesThatSayWhatTheyWantAreAllAnswered) {
  boost::asio::io_context io;
  auto sockets = crowd(io, port, kTooMany, "GET / HTTP/1.1\r\n" + host_header() + "\r\n");
  int answered = 0;
  for (tcp::socket& socket : sockets) {
    std::array<char, 12> start{};
    beast::error_code error;
    boost::asio::read(socket, boost::asio::buffer(start), error);
    answered += std::string_view(start.data(), start.size()) == "HTTP/1.1 403";
  }
  EXPECT_EQ(answered, kTooMany);
}

// Where the system gives it fewer descriptors than it would use.
TEST_F(ConsoleTest, WithoutDescriptorsItMakesRoomToo) {
  const rlimit few{100, 100};
  ASSERT_EQ(::prlimit(console->pid(), RLIMIT_NOFILE, &few, nullptr), 0);
  boost::asio::io_context io;
  const auto strangers = crowd(io, port, 300, "GET / HTTP/1.1\r\nX: ");
  const Nanos begin = monotonic_now();
  const auto page = open_page();
  ASSERT_TRUE(page->next_frame(kPatience));
  EXPECT_LT(monotonic_now() - begin, 4 * kSecond) << "before the strangers' time is over";
}

TEST_F(ConsoleTest, WhatIsTooLongOrNotUnderstoodEndsItsPageAlone) {
  const auto page = open_page();
  const auto bad = open_page();
  bad->say(std::string(70'000, ' '));
  while (bad->next(kSecond)) {
  }
  EXPECT_EQ(bad->close_code(), 1009) << "too long, whatever it says";
  const auto garbled = open_page();
  garbled->say("{\"nonsense\": 1}");
  while (garbled->next(kSecond)) {
  }
  EXPECT_EQ(garbled->close_code(), 1008);
  EXPECT_EQ(web_get(port, "/", own_headers() + "X: " + std::string(10'000, 'x') + "\r\n").status,
            431u);
  EXPECT_TRUE(sees_pages(*page, 1));
}

TEST_F(ConsoleTest, AFloodOfPingsEndsItsPageAlone) {
  const auto page = open_page();
  const auto flood = open_page();
  beast::error_code error;
  for (int i = 0; i < 2000 && !error; ++i) flood->socket().ping("x", error);
  EXPECT_TRUE(sees_pages(*page, 1));
}

TEST_F(ConsoleTest, StartedTwiceOnAPortItSaysWhoMayBeThere) {
  Program twice(folder, "handrail-console", {"--socket", socket(), "--listen", host()});
  EXPECT_EQ(twice.finish(), 2);
  EXPECT_THAT(twice.output(), HasSubstr("in use, likely by another handrail-console"));
}

}  // namespace
}  // namespace handrail
