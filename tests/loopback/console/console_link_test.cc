// The console where other computers reach it: over TLS, by links that are good once.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <thread>

#include "server/keys/web_place.h"
#include "tests/loopback/console/console_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ConsoleLinkTest : public ConsoleCell {
 protected:
  void SetUp() override {
    keys = folder.path() + "/keys";
    ::setenv("HANDRAIL_KEYS", keys.c_str(), 1);
    WholeCell::SetUp();
    ASSERT_EQ(handrail({"keys", "new", "operator"}).first, 0);
    start_remote();
  }
  void TearDown() override { ::unsetenv("HANDRAIL_KEYS"); }
  void start_remote(const std::string& listen = "any:0") {
    folder.write("page/index.html", "<p>page</p>");
    console = std::make_unique<Program>(
        folder, "handrail-console",
        std::vector<std::string>{"--socket", socket(), "--page", folder.path() + "/page",
                                 "--listen", listen, "--name", "127.0.0.1"},
        streams);
    url = console->after("READY url=");
    port = std::atoi(url.substr(url.rfind(':') + 1).c_str());
    ASSERT_EQ(url, "https://" + host() + "/");
  }
  // The token of a new link.
  std::string link(std::vector<std::string> words) {
    words.insert(words.begin(), {"keys", "link"});
    const auto [code, output] = handrail(words);
    EXPECT_EQ(code, 0) << output;
    last_output = output;
    const std::size_t at = output.find("?once=");
    return at == std::string::npos ? "" : output.substr(at + 6, output.find('\n', at) - at - 6);
  }
  // As the button does it.
  WebReply open_link(const std::string& token) const {
    return tls_get(port, "/?once=" + token, host_header() + "Origin: https://" + host() + "\r\n",
                   "POST");
  }
  WebPage::Asks asks_of(const std::string& with) const {
    return {host(), "https://" + host(), with};
  }
  std::unique_ptr<TlsPage> open_by(const std::string& with) const {
    auto out = std::make_unique<TlsPage>();
    const WebPage::Asks asks = asks_of(with);
    EXPECT_EQ(out->open(port, {asks.host, asks.origin, asks.cookie}), "");
    return out;
  }
  // The certificate that whoever comes is shown.
  Certificate shown_certificate() const {
    boost::asio::io_context io;
    TlsBytes stream(io, taking_all());
    beast::error_code error;
    connect_web(stream, port, error);
    EXPECT_FALSE(error) << error.message();
    EXPECT_STREQ(SSL_get_version(stream.native_handle()), "TLSv1.3");
    return {SSL_get1_peer_certificate(stream.native_handle()), X509_free};
  }
  std::string keys, last_output;
};

TEST_F(ConsoleLinkTest, AnOperatorsLinkLetsItsBrowserInOnceAndItDrives) {
  const std::string token = link({"operator"});
  EXPECT_EQ(tls_get(port, "/", host_header()).status, 403u);
  const WebReply in = open_link(token);
  ASSERT_EQ(in.status, 303u) << in.body;
  EXPECT_EQ(in.location, "/");
  EXPECT_THAT(in.attributes, HasSubstr("; Secure"));
  EXPECT_THAT(in.attributes, HasSubstr("; HttpOnly"));
  EXPECT_EQ(tls_get(port, "/", host_header() + "Cookie: " + in.cookie + "\r\n").body,
            "<p>page</p>");
  const auto page = open_by(in.cookie);
  ASSERT_TRUE(page->ask(lead("TAKE"), 1, kPatience).value().done());
  EXPECT_EQ(engage_by(*page, 2), "");
  EXPECT_EQ(status().state(), "engaged");
  const WebReply again = open_link(token);
  EXPECT_EQ(again.status, 403u);
  EXPECT_EQ(again.cookie, "");
  EXPECT_THAT(again.body, HasSubstr("opened before"));
}

TEST_F(ConsoleLinkTest, AMessagesPreviewUsesNoLinkUp) {
  const std::string token = link({"operator"});
  for (int i = 0; i < 3; ++i) {
    const WebReply preview = tls_get(port, "/?once=" + token, host_header());
    EXPECT_EQ(preview.status, 200u);
    EXPECT_THAT(preview.body, HasSubstr("<form method=\"post\">"));
    EXPECT_EQ(preview.cookie, "");
  }
  const std::string foreign = host_header() + "Origin: https://evil.example\r\n";
  EXPECT_EQ(tls_get(port, "/?once=" + token, foreign, "POST").status, 403u);
  EXPECT_EQ(tls_get(port, "/?once=" + token, host_header(), "POST").status, 403u);
  EXPECT_EQ(open_link(token).status, 303u);
}

TEST_F(ConsoleLinkTest, AnObserversLinkLetsItsBrowserLookAndOrderNothing) {
  order("engage: true");
  const auto page = open_by(open_link(link({"observer", "--for", "1"})).cookie);
  const auto hello = page->wait_for(kPatience, [](const pb::ToPage& f) { return f.has_hello(); });
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->hello().role(), pb::Hello::OBSERVER);
  EXPECT_TRUE(
      page->wait_for(kPatience, [](const pb::ToPage& f) { return f.status().has_status(); }));
  EXPECT_FALSE(page->ask(lead("TAKE_OVER"), 1, kPatience).value().done());
  EXPECT_THAT(page->ask(request(2, R"({"stop": true})"), 2, kPatience).value().reason(),
              HasSubstr("only looks"));
  EXPECT_EQ(status().state(), "engaged");
}

TEST_F(ConsoleLinkTest, OfTwoBrowsersAtOnceOneIsLetIn) {
  for (int round = 0; round < 5; ++round) {
    const std::string token = link({"observer"});
    WebReply answers[2];
    std::thread other([&] { answers[0] = open_link(token); });
    answers[1] = open_link(token);
    other.join();
    EXPECT_EQ(answers[0].status + answers[1].status, 303u + 403u)
        << answers[0].body << answers[1].body;
    sleep_until(monotonic_now() + kSecond);  // so many are tried in a second and no more
  }
}

TEST_F(ConsoleLinkTest, AnUnknownLinkIsToldNothingAndOnlySoManyAreTried) {
  const WebReply unknown = open_link(std::string(32, 'a'));
  EXPECT_EQ(unknown.status, 403u);
  EXPECT_THAT(unknown.body, HasSubstr("no such link"));
  int told_to_wait = 0;
  for (int i = 0; i < 12; ++i) told_to_wait += open_link(std::string(32, 'b')).status == 429;
  EXPECT_GE(told_to_wait, 4);
  sleep_until(monotonic_now() + kSecond);
  EXPECT_EQ(open_link(link({"operator"})).status, 303u) << "and later it goes on";
}

TEST_F(ConsoleLinkTest, ALinkThatIsOverIsToldSo) {
  const std::string token = link({"operator", "--for", "1"});
  // As if it had been made an hour ago.
  const std::string path = keys + "/links";
  std::string text;
  {
    std::ifstream file(path);
    std::getline(file, text, '\0');
  }
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex(" ([0-9]{10}) ([0-9]{10}) ")));
  const std::string before = " " + std::to_string(std::atoll(found.str(1).c_str()) - 3600) + " " +
                             std::to_string(std::atoll(found.str(2).c_str()) - 3600) + " ";
  text.replace(static_cast<std::size_t>(found.position()), static_cast<std::size_t>(found.length()),
               before);
  std::ofstream(path) << text;
  const WebReply late = open_link(token);
  EXPECT_EQ(late.status, 403u);
  EXPECT_EQ(late.cookie, "");
  EXPECT_THAT(late.body, HasSubstr("for a while that is over"));
}

TEST_F(ConsoleLinkTest, ALinkThatIsRemovedTakesItsPagesWithIt) {
  const std::string cookie_of_it = open_link(link({"operator"})).cookie;
  const auto page = open_by(cookie_of_it);
  const auto [listed, links] = handrail({"keys", "links"});
  EXPECT_EQ(listed, 0);
  EXPECT_THAT(links, HasSubstr("  operator  used "));
  ASSERT_TRUE(page->ask(lead("TAKE"), 1, kPatience).value().done());
  ASSERT_EQ(handrail({"keys", "unlink", links.substr(0, 6)}).first, 0) << links;
  const Nanos begin = monotonic_now();
  while (page->next(2 * kSecond)) {
    if (monotonic_now() - begin > 10 * kSecond) break;
  }
  EXPECT_LT(monotonic_now() - begin, 3 * kSecond);
  EXPECT_EQ(page->close_code(), 1008);
  EXPECT_EQ(TlsPage().open(port, {host(), "https://" + host(), cookie_of_it}), "403");
}

TEST_F(ConsoleLinkTest, AnotherKeyIsShownToWhoComesAndWhoIsInStays) {
  const auto page = open_by(open_link(link({"operator"})).cookie);
  const std::string before = fingerprint(shown_certificate());
  ASSERT_TRUE(std::filesystem::remove(keys + "/key"));
  ASSERT_EQ(handrail({"keys", "new", "operator"}).first, 0);
  EXPECT_TRUE(within(kPatience, [&] { return fingerprint(shown_certificate()) != before; }));
  (void)link({"observer"});
  EXPECT_THAT(last_output, HasSubstr(fingerprint(shown_certificate())));
  EXPECT_THAT(last_output, Not(HasSubstr(before)));
  EXPECT_TRUE(page->ask(lead("TAKE"), 1, kPatience).value().done());
}

TEST_F(ConsoleLinkTest, TheLinkSaysWhatToCompareWithTheCertificateThatIsShown) {
  (void)link({"operator"});
  const Certificate shown = shown_certificate();
  const std::string before = fingerprint(shown);
  EXPECT_THAT(last_output, HasSubstr(before));
  EXPECT_THAT(last_output, HasSubstr(fingerprint_start(shown)));
  console->send(SIGTERM);
  EXPECT_EQ(console->finish(), 0);
  start_remote("any:" + std::to_string(port));
  (void)link({"observer"});
  EXPECT_THAT(last_output, HasSubstr(before)) << "a browser that took it is not asked again";
}

TEST_F(ConsoleLinkTest, PlainBytesOlderTlsAndOtherNamesAreNotServed) {
  EXPECT_EQ(web_get(port, "/", host_header()).status, 0u) << "never plain";
  boost::asio::ssl::context old(boost::asio::ssl::context::tlsv12_client);
  boost::asio::io_context io;
  TlsBytes stream(io, old);
  beast::error_code error;
  connect_web(stream, port, error);
  EXPECT_TRUE(error) << "TLS 1.3 alone";
  const std::string token = link({"operator"});
  EXPECT_EQ(tls_get(port, "/?once=" + token, "Host: evil.example\r\n").status, 403u);
  EXPECT_EQ(tls_get(port, "/?once=" + token,
                    "Host: evil.example\r\nOrigin: https://evil.example\r\n", "POST")
                .status,
            403u);
  const WebReply in = open_link(token);
  EXPECT_EQ(in.status, 303u) << "what came by another name has not used it up";
  for (const std::string& origin : {std::string("http://"), std::string("https://evil.")}) {
    EXPECT_EQ(TlsPage().open(port, {host(), origin + host(), in.cookie}), "403") << origin;
  }
}

TEST_F(ConsoleLinkTest, MoreHalfGreetingsThanItTakesKeepNobodyOut) {
  const std::string token = link({"observer"});
  const double before = memory();
  boost::asio::io_context io;
  const auto strangers = crowd(io, port, kTooMany, std::string("\x16\x03\x01\x02\x00\x01", 6));
  const Nanos begin = monotonic_now();
  const WebReply in = open_link(token);
  EXPECT_EQ(in.status, 303u) << in.body;
  EXPECT_LT(monotonic_now() - begin, kSecond);
  EXPECT_LT(memory() - before, 64.0) << "MiB";
  // And whoever begins otherwise goes at once.
  tcp::socket other(io);
  other.connect(console_at(port));
  boost::asio::write(other, boost::asio::buffer("GET / HTTP/1.1\r\n", 16));
  char byte = 0;
  beast::error_code error;
  const Nanos asked = monotonic_now();
  (void)other.read_some(boost::asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error) << "told nothing";
  EXPECT_LT(monotonic_now() - asked, kSecond);
}

TEST_F(ConsoleLinkTest, SaysWhatIsMissingForALink) {
  EXPECT_THAT(handrail({"keys", "link", "master"}).second, HasSubstr("expected operator"));
  EXPECT_THAT(handrail({"keys", "link", "observer", "--for", "0"}).second,
              HasSubstr("a whole number of 1 to 1440"));
  ::setenv("HANDRAIL_KEYS", (folder.path() + "/none").c_str(), 1);
  EXPECT_THAT(handrail({"keys", "link", "observer"}).second,
              HasSubstr("start `handrail-console --listen"));
  Program keyless(folder, "handrail-console",
                  {"--socket", socket(), "--listen", "any:0", "--name", "127.0.0.1"});
  EXPECT_EQ(keyless.finish(), 2);
  EXPECT_THAT(keyless.output(), HasSubstr("`handrail keys new` makes one"));
}

}  // namespace
}  // namespace handrail
