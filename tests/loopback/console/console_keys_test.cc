// A console of a master on another computer, while the keys that they know each other by change.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/loopback/console/web_client.h"
#include "tests/loopback/secure_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class ConsoleElsewhere : public SecureCell {
 protected:
  void SetUp() override {
    make_keys();
    start_rig();
    launch_secure_slave();
    launch_secure_master("operator_address: '127.0.0.1' operator_port: 0 ");
    const int port = master->number_after("operators=127.0.0.1:");
    TrustList of_master = *at_master.trusted(), of_anna;
    ASSERT_TRUE(of_master.add(anna.create("anna", Role::kOperator)->entry()));
    ASSERT_TRUE(of_anna.add(at_master.load()->entry()));
    ASSERT_TRUE(at_master.save(of_master, "a test") && anna.save(of_anna, "a test"));
    ::setenv("HANDRAIL_KEYS", anna.path().c_str(), 1);
    folder.write("page/index.html", "<p>page</p>");
    console = std::make_unique<Program>(
        folder, "handrail-console",
        std::vector<std::string>{"--master", "localhost:" + std::to_string(port), "--page",
                                 folder.path() + "/page"});
    const std::string url = console->after("READY url=");
    const int at = std::atoi(url.substr(url.find(':', 5) + 1).c_str());
    const std::string host = "127.0.0.1:" + std::to_string(at);
    const WebReply in = web_get(at, url.substr(url.find("/?")), "Host: " + host + "\r\n");
    ASSERT_EQ(page.open(at, {host, "http://" + host, in.cookie}), "");
  }
  // The page's next status with one of the master, or with a problem that says so.
  bool shows_status() {
    return page.wait_for(kPatience, [](const pb::ToPage& f) { return f.status().has_status(); })
        .has_value();
  }
  bool says(const std::string& problem) {
    return page
        .wait_for(kPatience,
                  [&](const pb::ToPage& f) {
                    return f.status().problem().find(problem) != std::string::npos;
                  })
        .has_value();
  }

  KeyFolder anna{folder.path() + "/anna-keys"};
  std::unique_ptr<Program> console;
  WebPage page;
};

TEST_F(ConsoleElsewhere, AMasterThatIsTrustedNoLongerIsLeftAtOnceAndFoundAgain) {
  ASSERT_TRUE(shows_status());
  const TrustList before = *anna.trusted();
  ASSERT_TRUE(anna.save(TrustList(), "a test"));
  EXPECT_TRUE(says("keys trust")) << "what is open ends too";
  ASSERT_TRUE(anna.save(before, "a test"));
  EXPECT_TRUE(shows_status());
}

}  // namespace
}  // namespace handrail
