// The bytes of proto/WIRE.md, which our encoder did not write, against the codec.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/support/bad_datagrams.h"
#include "tests/support/no_allocation.h"
#include "tests/unit/link/link_samples.h"

namespace handrail {
namespace {

// The bytes of the code block below the heading `heading`.
std::vector<std::uint8_t> golden(const std::string& heading) {
  std::ifstream file(HANDRAIL_SOURCE_DIR "/proto/WIRE.md");
  std::vector<std::uint8_t> bytes;
  std::string line;
  while (std::getline(file, line) && line != heading) {
  }
  while (std::getline(file, line) && line != "```") {
  }
  while (std::getline(file, line) && line != "```") {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(word, nullptr, 16)));
    }
  }
  return bytes;
}

const DatagramHeader kMasterHeader = {.session = 0x0123456789abcdef,
                                      .sequence = 7,
                                      .sent = 5'000'000'000,
                                      .echo_session = 0xfedcba9876543210,
                                      .echo_sequence = 6,
                                      .echo_sent = 1'250'000'000,
                                      .echo_held = 400'000,
                                      .received_of_100 = 98};
const DatagramHeader kSlaveHeader = {.session = 0xfedcba9876543210,
                                     .sequence = 0x100000001,
                                     .sent = 1'250'500'000,
                                     .echo_session = 0x0123456789abcdef,
                                     .echo_sequence = 7,
                                     .echo_sent = 5'000'000'000,
                                     .echo_held = 0,
                                     .received_of_100 = 97};

TEST(Golden, MasterBytesDecodeToTheDocumentedValues) {
  const auto bytes = golden("### Master");
  ASSERT_EQ(bytes.size(), 478u);
  Codec codec;
  DatagramHeader header;
  MasterState state;
  ASSERT_EQ(codec.decode(bytes, header, state), Reject::kNone);
  EXPECT_EQ(header, kMasterHeader);
  EXPECT_TRUE(same(state, sample_master()));
}

TEST(Golden, SlaveBytesDecodeToTheDocumentedValues) {
  const auto bytes = golden("### Slave");
  ASSERT_EQ(bytes.size(), 546u);
  Codec codec;
  DatagramHeader header;
  SlaveState state;
  ASSERT_EQ(codec.decode(bytes, header, state), Reject::kNone);
  EXPECT_EQ(header, kSlaveHeader);
  EXPECT_TRUE(same(state, sample_slave()));
  ASSERT_TRUE(state.surface);
  EXPECT_LT((state.surface->n_S - Vec3(2, -3, -2) / std::sqrt(17.0)).norm(), 1e-15);
}

TEST(Golden, RefusalBytesAreTheDocumentedValues) {
  const Refusal refusal{0x0123456789abcdef, true,
                        fixed_text<LeaderName>("process 4711 on this computer"), 12'500'000'000};
  const auto bytes = golden("### Refusal");
  ASSERT_EQ(bytes.size(), 63u);
  Codec codec;
  Refusal decoded;
  ASSERT_EQ(codec.decode(bytes, decoded), Reject::kNone);
  EXPECT_EQ(decoded, refusal);
  std::vector<std::uint8_t> out(kMaxDatagram);
  out.resize(codec.encode(refusal, out));
  EXPECT_EQ(out, bytes);
  EXPECT_EQ(leader_text(refusal, kSecond), "process 4711 on this computer, for 13 s");
  for (auto flipped = bytes; std::size_t bit : {0u, 40u, 100u, 200u, 300u, 503u}) {
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    EXPECT_NE(codec.decode(flipped, decoded), Reject::kNone) << bit;
    flipped = bytes;
  }
}

TEST(Golden, ARefusalOutOfRangeIsNeitherSentNorTaken) {
  Codec codec;
  std::vector<std::uint8_t> out(kMaxDatagram);
  const auto named = [](std::string_view name) { return fixed_text<LeaderName>(name); };
  const LeaderName longest = named(std::string(47, 'x'));
  for (const Refusal& bad :
       {Refusal{0, false, longest, 0}, Refusal{1, false, {}, 0}, Refusal{1, false, named("a\n"), 0},
        Refusal{1, false, named("a/b"), 0}, Refusal{1, false, longest, -1}}) {
    EXPECT_EQ(codec.encode(bad, out), 0u);
  }
  const Refusal sound{1, false, longest, 0};
  const std::size_t size = codec.encode(sound, out);
  EXPECT_EQ(size, 81u);
  Refusal decoded;
  EXPECT_EQ(codec.decode(std::span(out).first(size), decoded), Reject::kNone);
  EXPECT_EQ(decoded, sound);
  EXPECT_LT(size, datagram(sample_header(), MasterState()).size()) << "of any that it answers";
}

TEST(Golden, ARefusalThatIsWrongFailsItsOwnCheck) {
  Codec codec;
  Refusal decoded;
  for (const auto& bad : test::bad_refusals(1)) {
    const Reject cause = bad.cause == Reject::kStale ? Reject::kNone : bad.cause;
    EXPECT_EQ(codec.decode(bad.bytes, decoded), cause) << describe(bad.cause);
  }
}

TEST(Golden, ALeadersNameIsReadAloudWithoutSurprises) {
  for (const char* good : {"process 4711 on this computer", "ada@10.0.0.2:47001", "A-b_c"}) {
    EXPECT_TRUE(is_leader_name(good)) << good;
  }
  for (const std::string& bad : {std::string(), std::string(48, 'x'), std::string("a\0b", 3),
                                 std::string("a;b"), std::string("\x1b[2J"), std::string("\xc3")}) {
    EXPECT_FALSE(is_leader_name(bad)) << bad;
  }
}

TEST(Golden, ARefusalIsWrittenAndReadWithoutAllocation) {
  Codec codec;
  std::array<std::uint8_t, kMaxDatagram> out{};
  const Refusal refusal{1, false, fixed_text<LeaderName>(std::string(47, 'x')), 0};
  Refusal decoded;
  {
    const test::NoAllocation guard("refusal");
    const std::size_t size = codec.encode(refusal, out);
    (void)codec.decode(std::span(out).first(size), decoded);
  }
  EXPECT_EQ(decoded, refusal);
}

TEST(Golden, EncodingTheDocumentedValuesGivesTheSameBytes) {
  EXPECT_EQ(datagram(kMasterHeader, sample_master()), golden("### Master"));
  EXPECT_EQ(datagram(kSlaveHeader, sample_slave()), golden("### Slave"));
}

TEST(Golden, EveryTruncationIsRefused) {
  const auto bytes = golden("### Master");
  Codec codec;
  DatagramHeader header;
  MasterState state;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto cut = std::span(bytes).first(size);
    EXPECT_EQ(codec.decode(cut, header, state), size < 12 ? Reject::kSize : Reject::kLength)
        << size;
  }
}

TEST(Golden, TrailingBytesAreRefused) {
  auto bytes = golden("### Slave");
  Codec codec;
  DatagramHeader header;
  SlaveState state;
  bytes.push_back(0);
  EXPECT_EQ(codec.decode(bytes, header, state), Reject::kLength);
  bytes.resize(kMaxDatagram + 1);
  EXPECT_EQ(codec.decode(bytes, header, state), Reject::kSize);
}

TEST(Golden, EverySingleBitFlipIsRefused) {
  Codec codec;
  DatagramHeader header;
  MasterState master;
  SlaveState slave;
  for (const char* heading : {"### Master", "### Slave"}) {
    auto bytes = golden(heading);
    ASSERT_GT(bytes.size(), 400u);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      EXPECT_NE(codec.decode(bytes, header, master), Reject::kNone) << heading << " bit " << bit;
      EXPECT_NE(codec.decode(bytes, header, slave), Reject::kNone) << heading << " bit " << bit;
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    }
  }
}

TEST(Golden, TheOtherDirectionIsRefused) {
  Codec codec;
  DatagramHeader header;
  MasterState master;
  SlaveState slave;
  EXPECT_EQ(codec.decode(golden("### Master"), header, slave), Reject::kKind);
  EXPECT_EQ(codec.decode(golden("### Slave"), header, master), Reject::kKind);
}

TEST(Golden, AnotherVersionIsRefusedAsSuch) {
  auto bytes = golden("### Master");
  ASSERT_FALSE(bytes.empty());
  bytes[4] = 1;
  Codec codec;
  DatagramHeader header;
  MasterState master;
  EXPECT_EQ(codec.decode(bytes, header, master), Reject::kVersion);
}

}  // namespace
}  // namespace handrail
