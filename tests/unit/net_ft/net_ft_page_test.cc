// The page of a Net F/T, as text and from a made-up web server.
#include "devices/net_ft/net_ft_page.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <mutex>
#include <thread>
#include <vector>

#include "devices/net_ft/net_ft_driver.h"
#include "devices/net_ft/net_ft_page_socket.h"
#include "server/base/clock.h"
#include "server/base/pacer.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

std::string page(const std::string& force, const std::string& torque,
                 const std::string& more = "<comrdte>Enabled</comrdte>") {
  return "<?xml version='1.0'?>\n<netft><cfgcpf> 1000000 </cfgcpf>\n<cfgcpt>500000</cfgcpt>\n"
         "<scfgfu>" +
         force + "</scfgfu><scfgtu>" + torque + "</scfgtu>" + more + "</netft>\n";
}

std::string error_of(const std::string& xml) { return parse_net_ft_page(xml).message(); }

TEST(NetFtPage, ScaleRateAndHealthAreRead) {
  const auto read = parse_net_ft_page(
      page("N", "N-m",
           "<comrdte>Enabled</comrdte><comrdtrate>7000</comrdtrate><runstat>0x80010000</runstat>"));
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(read->counts_per_n, 1e6);
  EXPECT_EQ(read->counts_per_n_m, 5e5);
  EXPECT_TRUE(read->streams);
  EXPECT_EQ(read->rate_hz, 7000);
  EXPECT_EQ(read->status, 0x80010000u);
  EXPECT_FALSE(parse_net_ft_page(page("N", "N-m", "<comrdte>Disabled</comrdte>"))->streams);
}

// A pound-force is 4.44822 N and a pound-inch 0.112985 N m (NIST SP 811).
TEST(NetFtPage, OtherUnitsAreConverted) {
  const auto pounds = parse_net_ft_page(page("lbf", "lbf-in"));
  ASSERT_TRUE(pounds) << pounds.message();
  EXPECT_NEAR(pounds->counts_per_n, 1e6 / 4.44822, 0.5);
  EXPECT_NEAR(pounds->counts_per_n_m, 5e5 / 0.112985, 20.0);
  EXPECT_NEAR(parse_net_ft_page(page("kN", "N-mm"))->counts_per_n, 1e3, 1e-9);
  EXPECT_NEAR(parse_net_ft_page(page("N", "N-mm"))->counts_per_n_m, 5e8, 1e-3);
  EXPECT_NEAR(parse_net_ft_page(page("N", "lbf-ft"))->counts_per_n_m, 5e5 / 1.35582, 2.0);
}

TEST(NetFtPage, WhatIsMissingOrMeansNothingIsNamed) {
  EXPECT_THAT(error_of(""), HasSubstr("there is no cfgcpf: is this a Net F/T sensor?"));
  EXPECT_THAT(error_of("<cfgcpf>12"), HasSubstr("there is no cfgcpf"));
  EXPECT_THAT(error_of("<cfgcpf>-5</cfgcpf>"),
              HasSubstr("cfgcpf is '-5', expected a number above 0"));
  EXPECT_THAT(error_of("<cfgcpf>1e6</cfgcpf><cfgcpt>x</cfgcpt>"), HasSubstr("cfgcpt is 'x'"));
  EXPECT_THAT(error_of("<cfgcpf>inf</cfgcpf>"), HasSubstr("cfgcpf is 'inf'"));
  EXPECT_THAT(error_of(page("stone", "N-m")),
              HasSubstr("scfgfu is 'stone', expected N, kN, lbf, klbf, kg"));
  EXPECT_THAT(error_of(page("N", "")), HasSubstr("scfgtu is ''"));
  EXPECT_THAT(error_of(page("N\x01\x02", "N-m")), HasSubstr("scfgfu is 'N?"
                                                            "?'"));
}

// Serves one text to each who connects, and nobody on its UDP port.
class MadeUpPage {
 public:
  explicit MadeUpPage(std::string answer) : answer_(std::move(answer)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    works_ = ::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
             ::listen(listener_, 8) == 0 &&
             ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~MadeUpPage() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  MadeUpPage(const MadeUpPage&) = delete;
  MadeUpPage& operator=(const MadeUpPage&) = delete;

  bool works() const { return works_; }
  std::uint16_t port() const { return port_; }
  std::string asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }

 private:
  void serve() {
    for (;;) {
      const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (client < 0) return;
      std::array<char, 512> bytes{};
      const ssize_t n = ::recv(client, bytes.data(), bytes.size(), 0);
      {
        const std::lock_guard lock(mutex_);
        asked_.assign(bytes.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
      }
      (void)!::send(client, answer_.data(), answer_.size(), MSG_NOSIGNAL);
      ::close(client);
    }
  }

  std::string answer_, asked_;
  std::mutex mutex_;
  int listener_ = -1;
  bool works_ = false;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

const char kFound[] = "HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\n\r\n";

NetFtOptions sensor_at(const MadeUpPage& server) {
  NetFtOptions out;
  out.port = 9;  // discard: no record comes from there
  out.page_port = server.port();
  return out;
}

TEST(NetFtPageSocket, FetchesTheBodyAndAsksForNothingElse) {
  MadeUpPage server(kFound + page("N", "N-m"));
  ASSERT_TRUE(server.works());
  const auto body = fetch_net_ft_page("127.0.0.1", server.port(), 5 * kSecond);
  ASSERT_TRUE(body) << body.message();
  EXPECT_EQ(*body, page("N", "N-m"));
  EXPECT_TRUE(server.asked().starts_with("GET /netftapi2.xml HTTP/1.0\r\n")) << server.asked();
}

TEST(NetFtPageSocket, WhateverElseAnswersIsNamed) {
  const std::pair<std::string, std::string> cases[] = {
      {"HTTP/1.0 404 Not Found\r\n\r\n", "expected HTTP 200, got 'HTTP/1.0 404 Not Found'"},
      {"SSH-2.0-OpenSSH\r\n", "expected HTTP 200, got 'SSH-2.0-OpenSSH'"},
      {"", "expected HTTP 200, got ''"},
      {kFound + std::string(200'000, 'x'), "too long"}};
  for (const auto& [answer, cause] : cases) {
    MadeUpPage server(answer);
    const auto body = fetch_net_ft_page("127.0.0.1", server.port(), 5 * kSecond);
    EXPECT_THAT(body.message(), HasSubstr(cause));
    EXPECT_THAT(body.message(), HasSubstr("http://127.0.0.1:" + std::to_string(server.port())));
  }
  EXPECT_THAT(fetch_net_ft_page("127.0.0.1", 1, kSecond).message(), HasSubstr("refused"));
  EXPECT_THAT(fetch_net_ft_page("sensor", 80, kSecond).message(),
              HasSubstr("expected an IPv4 address"));
}

TEST(NetFtDriverPage, CalibrationTakesTheScaleFromThePage) {
  MadeUpPage server(kFound + page("lbf", "lbf-in", "<comrdte>Disabled</comrdte>"));
  NetFtOptions options = sensor_at(server);
  options.mount.X_TF.p = Vec3(0.001, 0.002, -0.03);
  NetFtDriver driver(options, false);
  auto found = driver.calibrate();
  ASSERT_TRUE(found) << found.message();
  EXPECT_THAT((*found)->block(), HasSubstr("counts_per_n: 224808.9"));
  EXPECT_THAT((*found)->block(), HasSubstr(" mount { offset_mm: [1, 2, -30] } }"));
  const std::vector<TestItem> items = (*found)->items();
  ASSERT_EQ(items.size(), 3u);
  EXPECT_THAT(items[0].fact, HasSubstr("configured is another"));
  EXPECT_EQ(items[1].verdict, Verdict::kBad);
  EXPECT_EQ(items[2].verdict, Verdict::kOk);
}

TEST(NetFtDriverPage, ThePageSaysWhyNoRecordComes) {
  {
    MadeUpPage server(kFound + page("N", "N-m", "<comrdte>Disabled</comrdte>"));
    const Sighting seen = NetFtDriver(sensor_at(server), false).probe().at(0);
    EXPECT_EQ(seen.readiness, Readiness::kUnfinished);
    EXPECT_THAT(seen.fact, HasSubstr("RDT is disabled on its page"));
  }
  {
    MadeUpPage server(kFound + page("N", "N-m"));
    EXPECT_THAT(NetFtDriver(sensor_at(server), false).probe().at(0).next, HasSubstr("firewall"));
  }
  NetFtOptions nobody;
  nobody.port = 9;
  nobody.page_port = 1;
  EXPECT_EQ(NetFtDriver(nobody, false).probe().at(0).readiness, Readiness::kAbsent);
}

TEST(NetFtDriverPage, OneOfOnRobotHasNoPage) {
  MadeUpPage server(kFound + page("N", "N-m"));
  NetFtOptions options = sensor_at(server);
  options.client = {.dialect = RdtDialect::kOnRobot,
                    .period_ms = 2,
                    .filter = 6,
                    .counts_per_n = 1e4,
                    .counts_per_n_m = 1e5};
  NetFtDriver driver(options, false);
  EXPECT_THAT(driver.calibrate().message(), HasSubstr("has no page"));
  EXPECT_EQ(driver.probe().at(0).readiness, Readiness::kAbsent);
  EXPECT_EQ(server.asked(), "");
  auto test = driver.test({.alone = true});
  ASSERT_TRUE(test) << test.message();
  EXPECT_THAT((*test)->block(), HasSubstr("dialect: ONROBOT rate_hz: 500 sensor_filter_hz: 1.5 }"));
}

}  // namespace
}  // namespace handrail
