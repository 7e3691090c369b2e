#include "client/console/gateway/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace handrail {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;
using Verdict = Access::Verdict;

class AccessTest : public ::testing::Test {
 protected:
  Access access{"thekey", "thecookie", "127.0.0.1", 8080};
  // A request of the page itself, as its browser makes it.
  WebRequest own(const std::string& target = "/app.js") const {
    WebRequest out;
    out.method = "GET";
    out.target = target;
    out.host = "127.0.0.1:8080";
    out.cookie = "other=1; handrail-console-8080=thecookie";
    return out;
  }
  WebRequest own_socket() const {
    WebRequest out = own("/ws");
    out.wants_socket = true;
    out.origin = "http://127.0.0.1:8080";
    return out;
  }
};

TEST_F(AccessTest, LetsInWhoShowsTheCookie) {
  EXPECT_EQ(access.judge(own()), Verdict::kIn);
  EXPECT_EQ(access.judge(own_socket()), Verdict::kIn);
  WebRequest by_name = own();
  by_name.host = "LocalHost:8080";
  EXPECT_EQ(access.judge(by_name), Verdict::kIn);
}

TEST_F(AccessTest, RefusesWithoutTheSecretOrWithAnother) {
  WebRequest request = own();
  for (const char* cookie : {"", "handrail-console-8080=", "handrail-console-8080=thecooki",
                             "handrail-console-8080=thecookie2", "handrail-console-8081=thecookie",
                             "xhandrail-console-8080=thecookie"}) {
    request.cookie = cookie;
    EXPECT_EQ(access.judge(request), Verdict::kRefused) << cookie;
  }
}

TEST_F(AccessTest, TheKeyIsChangedForACookieOfAnotherSecret) {
  WebRequest request = own("/?key=thekey");
  request.cookie = "";
  EXPECT_EQ(access.judge(request), Verdict::kShowsKey);
  const WebAnswer welcome = access.welcome();
  EXPECT_EQ(welcome.status, 303u);
  EXPECT_THAT(welcome.more, Contains(Pair("Location", "/")));
  EXPECT_THAT(welcome.more,
              Contains(Pair("Set-Cookie",
                            "handrail-console-8080=thecookie; HttpOnly; SameSite=Strict; Path=/")));
  for (const char* target : {"/?key=thekey2", "/?key=", "/x?key=thekey", "/?key=thekey&a=1"}) {
    request.target = target;
    EXPECT_EQ(access.judge(request), Verdict::kRefused) << target;
  }
  WebRequest socket = own_socket();
  socket.cookie = "";
  socket.target = "/?key=thekey";
  EXPECT_EQ(access.judge(socket), Verdict::kRefused) << "a WebSocket shows the cookie";
}

TEST_F(AccessTest, RefusesANameOfSomebodyElsesThatLeadsHere) {
  WebRequest request = own();
  for (const char* host : {"evil.example:8080", "127.0.0.1", "127.0.0.1:80", "", "localhost",
                           "127.0.0.1:8080.evil.example", "127.0.0.2:8080"}) {
    request.host = host;
    EXPECT_EQ(access.judge(request), Verdict::kRefused) << host;
  }
}

TEST_F(AccessTest, RefusesPagesFromElsewhere) {
  for (const char* origin : {"http://evil.example", "http://127.0.0.1:8081",
                             "http://localhost:8080", "https://127.0.0.1:8080", "null"}) {
    WebRequest file = own();
    WebRequest socket = own_socket();
    file.origin = socket.origin = origin;
    EXPECT_EQ(access.judge(file), Verdict::kRefused) << origin;
    EXPECT_EQ(access.judge(socket), Verdict::kRefused) << origin;
  }
  WebRequest without = own_socket();
  without.origin = "";
  EXPECT_EQ(access.judge(without), Verdict::kRefused) << "browsers always say it";
}

TEST_F(AccessTest, SaysTheAddressWithTheKeyAndARefusalSaysNothingOfIt) {
  EXPECT_EQ(access.url(), "http://127.0.0.1:8080/?key=thekey");
  const WebAnswer refusal = Access::refusal();
  EXPECT_EQ(refusal.status, 403u);
  EXPECT_THAT(*refusal.body, Not(HasSubstr("thekey")));
}

class ViewerAccessTest : public AccessTest {
 protected:
  ViewerAccessTest() {
    access.open_to_viewers("look", {"https://App.Foxglove.dev", "file://"});
    request.wants_socket = true;
    request.host = "127.0.0.1:8080";
    request.target = "/foxglove?key=look";
  }
  // "in", "key": the secret alone is right, or "".
  std::string verdict() const {
    bool shows_key = false;
    const bool in = access.lets_view(request, shows_key);
    return in ? "in" : shows_key ? "key" : "";
  }
  WebRequest request;
};

TEST_F(ViewerAccessTest, LetsInAProgramWithTheSecretAndPagesThatWereNamed) {
  EXPECT_EQ(verdict(), "in") << "a program says no Origin";
  for (const char* origin : {"https://app.foxglove.dev", "file://"}) {
    request.origin = origin;
    EXPECT_EQ(verdict(), "in") << origin;
  }
  for (const char* origin :
       {"null", "https://evil.example", "https://app.foxglove.dev.evil.example",
        "http://app.foxglove.dev", "http://127.0.0.1:8080"}) {
    request.origin = origin;
    EXPECT_EQ(verdict(), "key") << origin;
  }
}

TEST_F(ViewerAccessTest, RefusesAnotherSecretAndAnotherHost) {
  for (const char* target :
       {"/foxglove", "/foxglove?key=", "/foxglove?key=loo", "/foxglove?key=look2",
        "/foxglove?key=thekey", "/foxglove?key=look&a=1", "/foxglove/?key=look"}) {
    request.target = target;
    EXPECT_EQ(verdict(), "") << target;
  }
  request.target = "/foxglove?key=look";
  request.host = "evil.example:8080";
  EXPECT_EQ(verdict(), "");
}

TEST_F(ViewerAccessTest, TheViewersSecretOpensNothingElseAndThePagesNoViewer) {
  request.target = "/?key=look";
  request.wants_socket = false;
  EXPECT_EQ(access.judge(request), Verdict::kRefused);
  WebRequest page = own_socket();
  page.target = "/foxglove";
  bool shows_key = true;
  EXPECT_FALSE(access.lets_view(page, shows_key)) << "the page's cookie";
  EXPECT_FALSE(shows_key);
  EXPECT_FALSE(Access::is_for_viewers(own_socket()));
  EXPECT_TRUE(Access::is_for_viewers(page));
  const Access closed("thekey", "thecookie", "127.0.0.1", 8080);
  request.wants_socket = true;
  request.target = "/foxglove?key=";
  EXPECT_FALSE(closed.lets_view(request, shows_key)) << "without a secret there is none to show";
  EXPECT_EQ(access.viewer_url(), "ws://127.0.0.1:8080/foxglove?key=look");
}

TEST(Secrets, AreLongAndNeverTheSame) {
  const auto a = new_secret(), b = new_secret();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->size(), 32u);
  EXPECT_NE(*a, *b);
}

TEST(SafetyHeaders, AllowNothingInlineAndNothingFromElsewhere) {
  std::string policy;
  for (const auto& [name, value] : safety_headers("127.0.0.1:8080")) {
    if (name == "Content-Security-Policy") policy = value;
  }
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, HasSubstr("script-src 'self';"));
  EXPECT_THAT(policy, HasSubstr("connect-src 'self' ws://127.0.0.1:8080;"));
  EXPECT_THAT(policy, Not(HasSubstr("unsafe")));
  EXPECT_THAT(safety_headers(""), Contains(Pair("X-Content-Type-Options", "nosniff")));
}

}  // namespace
}  // namespace handrail
