// Requests out of the bytes of a client, as they come.
#include "server/master/request_stream.h"

#include <gtest/gtest.h>

#include "server/base/length_prefix.h"

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

}  // namespace
}  // namespace handrail
