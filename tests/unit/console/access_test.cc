#include "client/console/gateway/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/console/gateway/pace.h"

namespace handrail {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;
using Verdict = Access::Verdict;

class AccessTest : public ::testing::Test {
 protected:
  Access access{{{"127.0.0.1", "localhost"}, 8080, false}, "thekey", "thecookie"};
  static constexpr Nanos kNow = 1000 * kSecond;
  Verdict judged(const WebRequest& request) const { return access.judge(request, kNow).verdict; }
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
  EXPECT_EQ(judged(own()), Verdict::kIn);
  EXPECT_EQ(judged(own_socket()), Verdict::kIn);
  WebRequest by_name = own();
  by_name.host = "LocalHost:8080";
  EXPECT_EQ(judged(by_name), Verdict::kIn);
}

TEST_F(AccessTest, RefusesWithoutTheSecretOrWithAnother) {
  WebRequest request = own();
  for (const char* cookie : {"", "handrail-console-8080=", "handrail-console-8080=thecooki",
                             "handrail-console-8080=thecookie2", "handrail-console-8081=thecookie",
                             "xhandrail-console-8080=thecookie"}) {
    request.cookie = cookie;
    EXPECT_EQ(judged(request), Verdict::kRefused) << cookie;
  }
}

TEST_F(AccessTest, TheKeyIsChangedForACookieOfAnotherSecret) {
  WebRequest request = own("/?key=thekey");
  request.cookie = "";
  EXPECT_EQ(judged(request), Verdict::kShowsKey);
  const WebAnswer welcome = access.welcome();
  EXPECT_EQ(welcome.status, 303u);
  EXPECT_THAT(welcome.more, Contains(Pair("Location", "/")));
  EXPECT_THAT(welcome.more,
              Contains(Pair("Set-Cookie",
                            "handrail-console-8080=thecookie; HttpOnly; SameSite=Strict; Path=/")));
  for (const char* target : {"/?key=thekey2", "/?key=", "/x?key=thekey", "/?key=thekey&a=1"}) {
    request.target = target;
    EXPECT_EQ(judged(request), Verdict::kRefused) << target;
  }
  WebRequest socket = own_socket();
  socket.cookie = "";
  socket.target = "/?key=thekey";
  EXPECT_EQ(judged(socket), Verdict::kRefused) << "a WebSocket shows the cookie";
}

TEST_F(AccessTest, RefusesANameOfSomebodyElsesThatLeadsHere) {
  WebRequest request = own();
  for (const char* host : {"evil.example:8080", "127.0.0.1", "127.0.0.1:80", "", "localhost",
                           "127.0.0.1:8080.evil.example", "127.0.0.2:8080"}) {
    request.host = host;
    EXPECT_EQ(judged(request), Verdict::kRefused) << host;
  }
}

TEST_F(AccessTest, RefusesPagesFromElsewhere) {
  for (const char* origin : {"http://evil.example", "http://127.0.0.1:8081",
                             "http://localhost:8080", "https://127.0.0.1:8080", "null"}) {
    WebRequest file = own();
    WebRequest socket = own_socket();
    file.origin = socket.origin = origin;
    EXPECT_EQ(judged(file), Verdict::kRefused) << origin;
    EXPECT_EQ(judged(socket), Verdict::kRefused) << origin;
  }
  WebRequest without = own_socket();
  without.origin = "";
  EXPECT_EQ(judged(without), Verdict::kRefused) << "browsers always say it";
}

TEST_F(AccessTest, SaysTheAddressWithTheKeyAndARefusalSaysNothingOfIt) {
  EXPECT_EQ(access.url(), "http://127.0.0.1:8080/?key=thekey");
  const WebAnswer refusal = access.refusal();
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
  EXPECT_EQ(access.judge(request, 0).verdict, Verdict::kRefused);
  WebRequest page = own_socket();
  page.target = "/foxglove";
  bool shows_key = true;
  EXPECT_FALSE(access.lets_view(page, shows_key)) << "the page's cookie";
  EXPECT_FALSE(shows_key);
  EXPECT_FALSE(Access::is_for_viewers(own_socket()));
  EXPECT_TRUE(Access::is_for_viewers(page));
  const Access closed({{"127.0.0.1"}, 8080, false}, "thekey", "thecookie");
  request.wants_socket = true;
  request.target = "/foxglove?key=";
  EXPECT_FALSE(closed.lets_view(request, shows_key)) << "without a secret there is none to show";
  EXPECT_EQ(access.viewer_url(), "ws://127.0.0.1:8080/foxglove?key=look");
}

// Where other computers reach it.
class RemoteAccessTest : public ::testing::Test {
 protected:
  static constexpr Nanos kNow = 1000 * kSecond;
  static constexpr char kToken[] = "0123456789abcdef0123456789abcdef";

  WebRequest own(const std::string& target = "/app.js", const std::string& secret = "") const {
    WebRequest out;
    out.method = "GET";
    out.target = target;
    out.host = "desk.example.org:47004";
    if (!secret.empty()) out.cookie = "handrail-console-47004=" + secret;
    return out;
  }
  Access::Judged judged(const WebRequest& request, Nanos now = kNow) const {
    return access.judge(request, now);
  }

  Access access{{{"desk.example.org", "[fd00::2]"}, 47004, true}, "", ""};
};

TEST_F(RemoteAccessTest, NobodyIsInWithoutALinkAndNoKeyIsPrinted) {
  EXPECT_EQ(access.url(), "https://desk.example.org:47004/");
  EXPECT_EQ(judged(own()).verdict, Verdict::kRefused);
  EXPECT_EQ(judged(own("/?key=")).verdict, Verdict::kRefused);
  WebRequest empty = own();
  empty.cookie = "handrail-console-47004=";
  EXPECT_EQ(judged(empty).verdict, Verdict::kRefused) << "an empty cookie is no secret";
  EXPECT_THAT(*access.refusal().body, HasSubstr("handrail keys link"));
}

TEST_F(RemoteAccessTest, ALinkIsOpenedByTheButtonOfTheFirstPageAlone) {
  const std::string target = std::string("/?once=") + kToken;
  EXPECT_EQ(judged(own(target)).verdict, Verdict::kLooksAtLink) << "a message's preview";
  WebRequest head = own(target);
  head.method = "HEAD";
  EXPECT_EQ(judged(head).verdict, Verdict::kRefused);
  WebRequest button = own(target);
  button.method = "POST";
  for (const char* origin : {"", "null", "https://evil.example", "http://desk.example.org:47004"}) {
    button.origin = origin;
    EXPECT_EQ(judged(button).verdict, Verdict::kRefused) << origin;
  }
  button.origin = "https://desk.example.org:47004";
  EXPECT_EQ(judged(button).verdict, Verdict::kOpensLink);
  EXPECT_EQ(judged(button).token, kToken);
  button.target = "/?once=" + std::string(65, 'a');
  EXPECT_EQ(judged(button).verdict, Verdict::kRefused);
  button.target = std::string("/x?once=") + kToken;
  EXPECT_EQ(judged(button).verdict, Verdict::kRefused);
  button.target = target;
  button.host = "evil.example:47004";
  EXPECT_EQ(judged(button).verdict, Verdict::kRefused);
}

TEST_F(RemoteAccessTest, ThePageOfALinkPostsToItselfAndRunsNothing) {
  const WebAnswer page = Access::link_page();
  EXPECT_THAT(*page.body, HasSubstr("<form method=\"post\"><button"));
  EXPECT_THAT(*page.body, Not(HasSubstr("<script")));
  EXPECT_THAT(page.more,
              Contains(Pair("Content-Security-Policy",
                            AllOf(HasSubstr("default-src 'none'"), HasSubstr("form-action 'self'"),
                                  HasSubstr("frame-ancestors 'none'")))));
  EXPECT_THAT(page.more, Contains(Pair("Referrer-Policy", "same-origin")))
      << "with no-referrer a browser's POST says Origin null";
}

TEST_F(RemoteAccessTest, ASessionHasTheRoleOfItsLinkUntilItIsOver) {
  const WebAnswer in = access.let_in({true, "aaaaaa"}, "secret1", kNow + kSecond);
  EXPECT_EQ(in.status, 303u);
  EXPECT_THAT(in.more, Contains(Pair("Location", "/")));
  EXPECT_THAT(in.more, Contains(Pair("Set-Cookie",
                                     "handrail-console-47004=secret1; HttpOnly; SameSite=Strict; "
                                     "Path=/; Secure")));
  (void)access.let_in({false, "bbbbbb"}, "secret2", kNow + 2 * kSecond);
  const auto observer = judged(own("/", "secret1"));
  EXPECT_EQ(observer.verdict, Verdict::kIn);
  EXPECT_TRUE(observer.guest.observes);
  EXPECT_EQ(observer.guest.link, "aaaaaa");
  EXPECT_FALSE(judged(own("/", "secret2")).guest.observes);
  EXPECT_EQ(judged(own("/", "secret")).verdict, Verdict::kRefused);
  const Nanos over = kNow + kSecond;
  EXPECT_EQ(judged(own("/", "secret1"), over).verdict, Verdict::kRefused);
  EXPECT_EQ(judged(own("/", "secret2"), over).verdict, Verdict::kIn);
  EXPECT_FALSE(access.holds({true, "aaaaaa"}, over));
  EXPECT_TRUE(access.holds({false, "bbbbbb"}, over));
}

TEST_F(RemoteAccessTest, ASessionEndsWithItsLink) {
  (void)access.let_in({false, "aaaaaa"}, "secret1", kNow + kSecond);
  (void)access.let_in({false, "bbbbbb"}, "secret2", kNow + kSecond);
  access.keep_only({"bbbbbb", "cccccc"});
  EXPECT_EQ(judged(own("/", "secret1")).verdict, Verdict::kRefused);
  EXPECT_FALSE(access.holds({false, "aaaaaa"}, kNow));
  EXPECT_EQ(judged(own("/", "secret2")).verdict, Verdict::kIn);
}

TEST_F(RemoteAccessTest, TheOldestSessionGoesWhereThereAreTooMany) {
  for (std::size_t i = 0; i <= Access::kMostSessions; ++i) {
    (void)access.let_in({}, "secret" + std::to_string(i), kNow + kSecond);
  }
  EXPECT_EQ(judged(own("/", "secret0")).verdict, Verdict::kRefused);
  EXPECT_EQ(judged(own("/", "secret1")).verdict, Verdict::kIn);
}

TEST_F(RemoteAccessTest, TheOriginIsTheEncryptedOne) {
  (void)access.let_in({}, "secret", kNow + kSecond);
  WebRequest socket = own("/ws", "secret");
  socket.wants_socket = true;
  for (const char* origin : {"", "http://desk.example.org:47004", "https://desk.example.org",
                             "https://[fd00::2]:47004", "https://evil.example", "null"}) {
    socket.origin = origin;
    EXPECT_EQ(judged(socket).verdict, Verdict::kRefused) << origin;
  }
  socket.origin = "https://desk.example.org:47004";
  EXPECT_EQ(judged(socket).verdict, Verdict::kIn);
}

TEST(Pacing, LetsSoManyPassInASecondAndOfOneNetworkFewer) {
  Pace pace(2, 3);
  EXPECT_TRUE(pace.take("a", 0));
  EXPECT_TRUE(pace.take("a", 1));
  EXPECT_FALSE(pace.take("a", 2)) << "of this network";
  EXPECT_TRUE(pace.take("b", 3)) << "others are not kept out by it";
  EXPECT_FALSE(pace.take("c", 4)) << "of all";
  EXPECT_TRUE(pace.take("a", kSecond));
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
  EXPECT_THAT(
      safety_headers("desk:47004", true),
      Contains(Pair("Content-Security-Policy", HasSubstr("connect-src 'self' wss://desk:47004;"))));
  EXPECT_THAT(safety_headers(""), Contains(Pair("X-Content-Type-Options", "nosniff")));
}

}  // namespace
}  // namespace handrail
