// Foxglove's texts and bytes, as its specification writes them.
#include "client/console/viewer/viewer_protocol.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <gtest/gtest.h>

#include "proto/foxglove.pb.h"
#include "proto/operator.pb.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

// Every file after those that it imports, as whoever builds types from them needs it.
const google::protobuf::Descriptor* built(const pb::ViewerChannel& channel,
                                          google::protobuf::DescriptorPool& pool) {
  google::protobuf::FileDescriptorSet files;
  EXPECT_TRUE(files.ParseFromString(channel.schema()));
  for (const auto& file : files.file()) {
    if (pool.BuildFile(file) == nullptr) ADD_FAILURE() << file.name() << " cannot be built";
  }
  return pool.FindMessageTypeByName(channel.schema_name());
}

TEST(ViewerProtocol, DataIsOneByteTwoNumbersAndTheMessage) {
  const std::string frame = data_frame(0x01020304u, 0x1122334455667788, "abc");
  EXPECT_EQ(frame, std::string("\x01"
                               "\x04\x03\x02\x01"
                               "\x88\x77\x66\x55\x44\x33\x22\x11"
                               "abc"));
  EXPECT_EQ(data_frame(0, 0, "").size(), 13u);
  EXPECT_EQ(data_frame(4294967295u, 0, "").substr(1, 4), "\xff\xff\xff\xff");
}

TEST(ViewerProtocol, TextsAreJsonWithItsNames) {
  EXPECT_EQ(server_info_text("1.2", "77"),
            R"({"op":"serverInfo","name":"handrail-console 1.2","capabilities":[],)"
            R"("sessionId":"77"})");
  EXPECT_EQ(status_text(ViewerLevel::kInfo, "a\"b"),
            R"({"op":"status","level":0,"message":"a\"b"})");
  EXPECT_THAT(status_text(ViewerLevel::kError, ""), HasSubstr(R"("level":2)"));
  pb::ViewerAdvertise channels;
  channels.set_op("advertise");
  pb::ViewerChannel& channel = *channels.add_channels();
  channel.set_id(1);
  channel.set_topic("/t");
  channel.set_encoding("protobuf");
  channel.set_schema_name("x.Y");
  channel.set_schema_encoding("protobuf");
  channel.set_schema("\xfb\xff\x01z");  // base64 by hand: 111110 111111 111100 000001 011110 10
  EXPECT_EQ(advertise_text(channels),
            R"({"op":"advertise","channels":[{"id":1,"topic":"/t","encoding":"protobuf",)"
            R"("schemaName":"x.Y","schemaEncoding":"protobuf","schema":"+/8Beg=="}]})");
}

TEST(ViewerProtocol, ASchemaIsWholeWithItsImports) {
  google::protobuf::DescriptorPool foxglove, status;
  const auto* frames =
      built(viewer_channel(1, "/tf", *foxglove::FrameTransforms::descriptor()), foxglove);
  ASSERT_NE(frames, nullptr);
  EXPECT_EQ(frames->full_name(), "foxglove.FrameTransforms");
  const auto* type = built(viewer_channel(2, "/status", *pb::Status::descriptor()), status);
  ASSERT_NE(type, nullptr);
  // A reader that knows nothing but the schema.
  pb::Status told;
  told.set_state("engaged");
  told.mutable_tip()->add_position_mm(1.5);
  google::protobuf::DynamicMessageFactory factory(&status);
  const std::unique_ptr<google::protobuf::Message> read(factory.GetPrototype(type)->New());
  ASSERT_TRUE(read->ParseFromString(told.SerializeAsString()));
  EXPECT_EQ(read->ShortDebugString(), told.ShortDebugString());
}

TEST(ViewerProtocol, ReadsWhatAViewerAsksFor) {
  const auto read = viewer_frame(
      R"({"op": "subscribe", "subscriptions": [{"id": 3, "channelId": 1}, {"id": 4294967295, "channelId": 2}]})");
  ASSERT_TRUE(read) << read.message();
  EXPECT_EQ(read->op(), "subscribe");
  ASSERT_EQ(read->subscriptions_size(), 2);
  EXPECT_EQ(read->subscriptions(0).id(), 3u);
  EXPECT_EQ(read->subscriptions(0).channel_id(), 1u);
  EXPECT_EQ(read->subscriptions(1).id(), 4294967295u);
  const auto end = viewer_frame(R"({"op": "unsubscribe", "subscriptionIds": [3, 5]})");
  ASSERT_TRUE(end) << end.message();
  EXPECT_EQ(end->subscription_ids(1), 5u);
  const auto other = viewer_frame(R"({"op": "fetchAsset", "uri": "x", "requestId": 1})");
  ASSERT_TRUE(other) << "what we do not know is no error";
  EXPECT_EQ(other->op(), "fetchAsset");
}

TEST(ViewerProtocol, WhatIsNoMessageIsSaidInOneLine) {
  const std::string deep(60000, '[');
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[]"), std::string("null"), deep,
        std::string("\xff\xfe\x00\x01", 4), std::string("{\"op\": 1 2}"),
        std::string(R"({"op": {"a": 1}})"),
        std::string(R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 1}]})"),
        std::string(R"({"op": "subscribe", "subscriptions": [{"id": 0.5, "channelId": 1}]})"),
        std::string(R"({"op": "subscribe", "subscriptions": [{"id": 4294967296}]})")}) {
    const auto read = viewer_frame(text);
    EXPECT_FALSE(read) << text.substr(0, 80);
    EXPECT_EQ(read.message().find('\n'), std::string::npos);
    EXPECT_LT(read.message().size(), 300u);
  }
}

}  // namespace
}  // namespace handrail
