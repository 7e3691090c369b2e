#include "devices/net_ft/rdt_packet.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

namespace handrail {
namespace {

// Written by hand from the field table: rdt 0x01020304, ft 0x05060708, status 0x80000001, counts
// 1, -1, 0x12345678, INT32_MIN, INT32_MAX, -2.
constexpr std::array<std::uint8_t, 36> kRecord{
    0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x80, 0x00, 0x00, 0x01,
    0x00, 0x00, 0x00, 0x01, 0xff, 0xff, 0xff, 0xff, 0x12, 0x34, 0x56, 0x78,
    0x80, 0x00, 0x00, 0x00, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe};

using Request = std::array<std::uint8_t, 8>;
constexpr Request kStream{0x12, 0x34, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00};
constexpr Request kStop{0x12, 0x34, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
constexpr Request kBias{0x12, 0x34, 0x00, 0x42, 0x00, 0x00, 0x00, 0x00};
constexpr Request kStreamFive{0x12, 0x34, 0x00, 0x02, 0x00, 0x00, 0x00, 0x05};

TEST(RdtPacket, EncodesRequestsAsTheFieldTableSays) {
  EXPECT_EQ(encode_rdt(RdtRequest{RdtCommand::kStream, 0}), kStream);
  EXPECT_EQ(encode_rdt(RdtRequest{RdtCommand::kStop, 0}), kStop);
  EXPECT_EQ(encode_rdt(RdtRequest{RdtCommand::kBias, 0}), kBias);
  EXPECT_EQ(encode_rdt(RdtRequest{RdtCommand::kStream, 5}), kStreamFive);
}

TEST(RdtPacket, DecodesRequests) {
  const auto request = decode_rdt_request(kStreamFive);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->command, RdtCommand::kStream);
  EXPECT_EQ(request->value, 5u);
  EXPECT_EQ(decode_rdt_request(kBias)->command, RdtCommand::kBias);
  EXPECT_EQ(decode_rdt_request(kStop)->command, RdtCommand::kStop);
}

// As OptoForce's examples write them: 15 Hz, 10 ms.
TEST(RdtPacket, EncodesAndDecodesWhatOnRobotTakesBesides) {
  constexpr Request filter{0x12, 0x34, 0x00, 0x81, 0x00, 0x00, 0x00, 0x04};
  constexpr Request period{0x12, 0x34, 0x00, 0x82, 0x00, 0x00, 0x00, 0x0a};
  EXPECT_EQ(encode_rdt(RdtRequest{RdtCommand::kFilter, 4}), filter);
  EXPECT_EQ(encode_rdt(RdtRequest{RdtCommand::kPeriod, 10}), period);
  EXPECT_EQ(decode_rdt_request(filter)->value, 4u);
  EXPECT_EQ(decode_rdt_request(period)->command, RdtCommand::kPeriod);
  EXPECT_EQ(kRdtFilters[4], 15.0);
}

TEST(RdtPacket, RefusesRequestsOfAnotherHeaderCommandOrSize) {
  Request bad = kStream;
  bad[0] = 0x34;
  EXPECT_FALSE(decode_rdt_request(bad));
  bad = kStream;
  bad[3] = 0x03;
  EXPECT_FALSE(decode_rdt_request(bad));
  EXPECT_FALSE(decode_rdt_request(std::span(kStream).first(7)));
  EXPECT_FALSE(decode_rdt_request(kRecord));
  EXPECT_FALSE(decode_rdt_request({}));
}

TEST(RdtPacket, DecodesAndEncodesTheHandWrittenRecord) {
  const auto record = decode_rdt_record(kRecord);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->rdt_sequence, 0x01020304u);
  EXPECT_EQ(record->ft_sequence, 0x05060708u);
  EXPECT_EQ(record->status, 0x80000001u);
  const std::array<std::int32_t, 6> counts{1, -1, 0x12345678, INT32_MIN, INT32_MAX, -2};
  EXPECT_EQ(record->counts, counts);
  EXPECT_EQ(encode_rdt(*record), kRecord);
}

TEST(RdtPacket, RefusesRecordsOfEveryOtherSize) {
  for (std::size_t size = 0; size < 100; ++size) {
    const std::vector<std::uint8_t> bytes(size, 1);
    EXPECT_EQ(decode_rdt_record(bytes).has_value(), size == 36) << size;
  }
}

RC_GTEST_PROP(RdtPacketProperty, AnyBytesDecodeOrAreRefused,
              (const std::vector<std::uint8_t>& bytes)) {
  RC_ASSERT(decode_rdt_record(bytes).has_value() == (bytes.size() == kRdtRecordSize));
  if (const auto request = decode_rdt_request(bytes)) {
    RC_ASSERT(std::ranges::equal(encode_rdt(*request), bytes));
  }
}

}  // namespace
}  // namespace handrail
