#include "server/keys/host_port.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(ParseHost, TakesNamesAddressesAndPorts) {
  const auto is = [](const std::string& text, const std::string& host, int port) {
    const auto got = parse_host(text, 47002);
    ASSERT_TRUE(got) << got.message();
    EXPECT_EQ(got->host, host);
    EXPECT_EQ(got->port, port);
  };
  is("cell", "cell", 47002);
  is("cell.example.org:5000", "cell.example.org", 5000);
  is("192.0.2.7", "192.0.2.7", 47002);
  is("2001:db8::7", "2001:db8::7", 47002);
  is("[2001:db8::7]", "2001:db8::7", 47002);
  is("[2001:db8::7]:1", "2001:db8::7", 1);
  is("fe80::1%eth0", "fe80::1%eth0", 47002);
}

TEST(ParseHost, AnyFreePortIsForWhoListens) {
  EXPECT_FALSE(parse_host("127.0.0.1:0", 47002));
  const auto got = parse_host("127.0.0.1:0", 47002, 0);
  ASSERT_TRUE(got) << got.message();
  EXPECT_EQ(got->port, 0);
}

TEST(ParseHost, RefusesWhatIsNeither) {
  for (const std::string& text :
       {std::string(), std::string("cell:"), std::string("cell:0"), std::string("cell:65536"),
        std::string("cell:4x"), std::string("[::1"), std::string("[::1]5"), std::string("[::1]:"),
        std::string("a b"), std::string("a/b"), std::string(254, 'a')}) {
    const auto got = parse_host(text, 47002);
    ASSERT_FALSE(got) << text;
    EXPECT_NE(got.message().find("expected a name or an address"), std::string::npos);
  }
}

}  // namespace
}  // namespace handrail
