#include "server/keys/web_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/x509v3.h>

#include <regex>

#include "server/keys/key_folder.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class WebPlaceTest : public ::testing::Test {
 protected:
  WebPlace made(const std::vector<std::string>& names) const {
    auto out = WebPlace::make(folder.path(), key, names);
    EXPECT_TRUE(out) << out.message();
    out->port = 47004;
    return *out;
  }
  TempFolder folder;
  OwnKey key = *OwnKey::generate();
};

TEST_F(WebPlaceTest, TheCertificateStaysAsLongAsKeyAndNamesDo) {
  const WebPlace first = made({"desk.example.org", "192.0.2.7"});
  ASSERT_TRUE(first.save(folder.path()));
  const auto loaded = WebPlace::load(folder.path());
  ASSERT_TRUE(loaded) << loaded.message();
  EXPECT_EQ(loaded->url(), "https://desk.example.org:47004/");
  const std::string shown = fingerprint(first.certificate);
  EXPECT_EQ(fingerprint(loaded->certificate), shown);
  EXPECT_EQ(fingerprint(made({"desk.example.org", "192.0.2.7"}).certificate), shown);
  EXPECT_NE(fingerprint(made({"desk.example.org"}).certificate), shown);
  key = *OwnKey::generate();
  EXPECT_NE(fingerprint(made({"desk.example.org", "192.0.2.7"}).certificate), shown);
}

TEST_F(WebPlaceTest, TheCertificateIsForItsNamesWithThisKey) {
  const Certificate certificate = made({"desk.example.org", "192.0.2.7", "fd00::2"}).certificate;
  EXPECT_TRUE(holds_key(certificate, key.public_key()));
  EXPECT_FALSE(holds_key(certificate, OwnKey::generate()->public_key()));
  EXPECT_EQ(X509_check_host(certificate.get(), "desk.example.org", 0, 0, nullptr), 1);
  EXPECT_EQ(X509_check_ip_asc(certificate.get(), "192.0.2.7", 0), 1);
  EXPECT_EQ(X509_check_ip_asc(certificate.get(), "fd00::2", 0), 1);
  EXPECT_EQ(X509_check_host(certificate.get(), "evil.example", 0, 0, nullptr), 0);
  EXPECT_THAT(WebPlace::make(folder.path(), key, {"a,DNS:evil.example"}).message(),
              HasSubstr("no certificate"));
}

TEST_F(WebPlaceTest, TheFingerprintIsAsABrowserShowsItAndItsStartAsAKeysId) {
  const Certificate certificate = made({"desk"}).certificate;
  const std::string whole = fingerprint(certificate);
  EXPECT_TRUE(std::regex_match(whole, std::regex("([0-9A-F]{2}:){31}[0-9A-F]{2}"))) << whole;
  std::string start;
  for (const char c : whole.substr(0, 23)) {
    if (c != ':') start += static_cast<char>(std::tolower(c));
  }
  for (const std::size_t at : {12u, 8u, 4u}) start.insert(at, "-");
  EXPECT_EQ(fingerprint_start(certificate), start);
}

TEST_F(WebPlaceTest, AnAddressOfIpv6IsInBracketsAndTheUsualPortLeftOut) {
  WebPlace place = made({"fd00::2"});
  EXPECT_EQ(place.url(), "https://[fd00::2]:47004/");
  place.port = 443;
  EXPECT_EQ(place.url(), "https://[fd00::2]/");
}

TEST_F(WebPlaceTest, SaysThatNoConsoleHasBeenThereOrThatTheFileIsNone) {
  EXPECT_THAT(WebPlace::load(folder.path()).message(), HasSubstr("handrail-console --listen"));
  folder.write("console", "handrail-console 47004 desk\nnonsense\n");
  EXPECT_THAT(WebPlace::load(folder.path()).message(), HasSubstr("and a certificate"));
}

// Two certificates of one issuer with one number: some browsers take neither.
TEST(Certificates, ForBrowsersHaveANumberOfTheirOwn) {
  const OwnKey key = *OwnKey::generate();
  const Certificate a = certificate_of(key, {"desk"}), b = certificate_of(key, {"desk"});
  EXPECT_NE(ASN1_INTEGER_cmp(X509_get0_serialNumber(a.get()), X509_get0_serialNumber(b.get())), 0);
}

}  // namespace
}  // namespace handrail
