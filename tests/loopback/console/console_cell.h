// A cell with a console, and pages that a test plays.
#pragma once

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "server/daemon/descriptors.h"
#include "tests/loopback/console/web_client.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {

class ConsoleCell : public WholeCell {
 protected:
  void start_console(std::vector<std::string> more = {}) {
    folder.write("page/index.html", "<p>page</p>");
    more.insert(more.begin(), {"--socket", socket(), "--page", folder.path() + "/page"});
    console = std::make_unique<Program>(folder, "handrail-console", more, streams);
    url = console->after("READY url=");
    port = std::atoi(url.substr(url.find(':', 5) + 1).c_str());
    const std::string key = url.substr(url.find("/?"));
    cookie = web_get(port, key, host_header()).cookie;
    ASSERT_FALSE(cookie.empty()) << url;
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(port); }
  std::string host_header() const { return "Host: " + host() + "\r\n"; }
  std::string own_headers() const { return host_header() + "Cookie: " + cookie + "\r\n"; }
  WebPage::Asks own_asks() const { return {host(), "http://" + host(), cookie}; }
  std::unique_ptr<WebPage> open_page() {
    auto out = std::make_unique<WebPage>();
    EXPECT_EQ(out->open(port, own_asks()), "");
    return out;
  }
  // More than the gateway takes, so that it has to make room.
  static constexpr int kTooMany = 1500;
  // Such a crowd, whose sockets are this process's; each has said `first`.
  static std::vector<boost::asio::ip::tcp::socket> crowd(boost::asio::io_context& io, int port,
                                                         int count, const std::string& first) {
    raise_descriptor_limit(kTooMany + 100);
    std::vector<boost::asio::ip::tcp::socket> out;
    for (int i = 0; i < count; ++i) {
      out.emplace_back(io);
      boost::system::error_code error;
      out.back().connect(console_at(port), error);
      if (!error) boost::asio::write(out.back(), boost::asio::buffer(first), error);
    }
    return out;
  }
  // Resident memory of the console [MiB].
  double memory() const {
    std::ifstream status("/proc/" + std::to_string(console->pid()) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) return std::atof(line.c_str() + 6) / 1024.0;
    }
    return 0.0;
  }
  static std::string lead(const std::string& act) {
    return R"({"lead": {"id": 1, "act": ")" + act + "\"}}";
  }
  static std::string request(std::uint32_t id, const std::string& order) {
    return R"({"request": {"id": )" + std::to_string(id) + ", \"order\": " + order + "}}";
  }
  // By a page that leads. Empty: engaged. A link that a busy machine disturbed is waited for.
  template <typename Page>
  std::string engage_by(Page& page, std::uint32_t id) {
    for (const Nanos give_up = monotonic_now() + kPatience;;) {
      const auto reply = page.ask(request(id, R"({"engage": true})"), id, kPatience);
      if (!reply) return "no answer";
      if (reply->done()) return "";
      if (reply->reason().find("the link is not good enough") == std::string::npos ||
          monotonic_now() > give_up) {
        return reply->reason();
      }
      sleep_until(monotonic_now() + 50 * kMillisecond);
    }
  }
  static std::string hand(std::uint64_t sequence, double x, double y, bool held) {
    return R"({"hand": {"sequence": ")" + std::to_string(sequence) + R"(", "position_mm": [)" +
           std::to_string(x) + ", " + std::to_string(y) + R"(, 0], "held": )" +
           (held ? "true" : "false") + "}}";
  }

  std::unique_ptr<Program> console;
  std::string url, cookie;
  int port = 0;
};

}  // namespace handrail
