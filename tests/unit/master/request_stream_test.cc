// Requests out of the bytes of a client, as they come.
#include "server/master/request_stream.h"

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "server/base/length_prefix.h"
#include "server/base/operator_name.h"

namespace handrail {
namespace {

std::string stop_frame() {
  pb::Request request;
  request.set_stop(true);
  return framed(request.SerializeAsString());
}

// What is said of the next request, "a request" of a sound one, "" while none is there.
std::string next_of(RequestStream& stream) {
  const auto request = stream.next();
  if (!request) return "";
  return request->is_ok() ? "a request" : request->message();
}

TEST(RequestStream, WaitsForTheLastByte) {
  RequestStream stream;
  const std::string frame = stop_frame();
  for (const char byte : frame) {
    EXPECT_EQ(next_of(stream), "");
    stream.append({&byte, 1});
  }
  const auto request = stream.next();
  ASSERT_TRUE(request && request->is_ok());
  EXPECT_TRUE((*request)->stop());
  EXPECT_EQ(stream.size(), 0u);
}

TEST(ClaimRequest, WhoSaysToOnlyLookGivesNoOrderAndNoStop) {
  const auto said = [](const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    return claim_request(nullptr, request);
  };
  EXPECT_EQ(said("observer: true status: true"), "");
  EXPECT_EQ(said("observer: true lease { act: SHOW }"), "");
  for (const char* order : {"engage: true", "stop: true", "lease { act: TAKE }", "cursor {}"}) {
    EXPECT_NE(said(std::string("observer: true ") + order), "") << order;
    EXPECT_EQ(said(order), "") << order;
  }
}

TEST(RequestStream, TakesOneAtATimeAndKeepsTheRest) {
  RequestStream stream;
  stream.append(stop_frame() + stop_frame() + "\x01");
  EXPECT_EQ(next_of(stream), "a request");
  EXPECT_EQ(next_of(stream), "a request");
  EXPECT_EQ(next_of(stream), "");
  EXPECT_EQ(stream.size(), 1u);
  stream.clear();
  EXPECT_EQ(stream.size(), 0u);
}

TEST(RequestStream, SaysWhatIsNoRequest) {
  const auto said = [](const std::string& bytes) {
    RequestStream stream;
    stream.append(bytes);
    return next_of(stream);
  };
  EXPECT_EQ(said({"\x00\x00\x01\x00", 4}), "") << "the longest";
  EXPECT_EQ(said({"\x01\x00\x01\x00", 4}), "a request of 65537 bytes, expected at most 65536");
  EXPECT_EQ(said("\xff\xff\xff\xff"), "a request of 4294967295 bytes, expected at most 65536");
  EXPECT_EQ(said(framed("\xff\xff")), "the request is garbled");
  EXPECT_EQ(said(framed("")), "the request holds no order");
  EXPECT_EQ(said(framed({"\x10\x00", 2})), "the request holds no order") << "engage: false";
}

pb::Request request_of(const std::string& text) {
  pb::Request out;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &out)) << text;
  return out;
}

Trusted trusted_as(Roles roles) {
  Trusted out{"anna", roles, {}};
  out.key.bytes[0] = 2;
  return out;
}

TEST(ClaimRequest, OverThisComputersSocketANameIsSaidAndHasTheFormOfOne) {
  const auto said = [](const std::string& text) {
    pb::Request request = request_of(text);
    return claim_request(nullptr, request);
  };
  EXPECT_EQ(said("engage: true"), "");
  EXPECT_EQ(said("as: 'ben' engage: true"), "");
  EXPECT_EQ(said("as: 'a b' engage: true"),
            "'a b' is no name: expected 1 to 32 letters, digits, '.', '_', '-'");
  EXPECT_NE(said("as: '' lease { act: TAKE }"), "");
  EXPECT_NE(said("as: '" + proven_name("anna", key_id(trusted_as({}).key)) + "' engage: true"), "")
      << "what only a key can prove";
}

TEST(ClaimRequest, OverTheNetworkTheKeySaysTheName) {
  const Trusted anna = trusted_as(Role::kOperator);
  const std::string proven = "anna@" + key_id(anna.key);
  for (const char* text : {"engage: true", "as: 'anna' stop: true", "lease { act: TAKE }"}) {
    pb::Request request = request_of(text);
    EXPECT_EQ(claim_request(&anna, request), "") << text;
    EXPECT_EQ(request.as(), proven) << text;
  }
  pb::Request other = request_of("as: 'ben' engage: true");
  EXPECT_NE(claim_request(&anna, other).find("yours says " + proven), std::string::npos);
}

TEST(ClaimRequest, AnObserverMayLookAndNothingElse) {
  const Trusted observer = trusted_as(Role::kObserver);
  for (const char* text : {"status: true", "lease { act: SHOW }"}) {
    pb::Request request = request_of(text);
    EXPECT_EQ(claim_request(&observer, request), "") << text;
  }
  for (const char* text :
       {"engage: true", "disengage: true", "clutch: true", "stop: true", "reset: true",
        "tool { kind: LINE }", "tool_off {}", "scene_load: 'a'", "hand { home: true }",
        "stage: 'a'", "lease { act: TAKE }", "lease { act: RELEASE }", "hold_alive: true"}) {
    pb::Request request = request_of(text);
    EXPECT_NE(claim_request(&observer, request)
                  .find("handrail keys trust anna operator " + key_text(observer.key)),
              std::string::npos)
        << text;
  }
}

}  // namespace
}  // namespace handrail
