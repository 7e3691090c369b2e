// Files of MCAP: what is written comes back; what is cut or spoilt gives what came before.
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "server/base/random.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/mcap/mcap_writer.h"

namespace handrail {
namespace {

struct McapText {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t time = 0;
  std::string data;
};

McapLayout two_channels() {
  McapLayout out;
  out.library = "test";
  out.schemas = {{"a.B", "protobuf", "described"}};
  out.channels = {{1, "/one", "protobuf"}, {0, "/two", "json"}};
  return out;
}

std::vector<McapText> some_messages(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<McapText> out;
  for (std::size_t i = 0; i < count; ++i) {
    McapText w;
    w.channel = static_cast<std::uint16_t>(1 + random.bits() % 2);
    w.sequence = static_cast<std::uint32_t>(i + 1);
    w.time = 1000 * i;
    w.data = std::string(random.bits() % 300, static_cast<char>('a' + random.bits() % 26));
    out.push_back(w);
  }
  return out;
}

// Four messages a chunk; `ends` gets where each chunk ends.
std::string file_of(const std::vector<McapText>& messages, std::vector<std::size_t>* ends = nullptr,
                    bool whole = true) {
  McapFile file(two_channels());
  std::string out = file.begin();
  McapChunkBuilder chunk;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const McapText& m = messages[i];
    chunk.add({m.channel, m.sequence, m.time, m.time, m.data});
    if (i % 4 != 3 && i + 1 != messages.size()) continue;
    const McapChunk closed = chunk.close();
    file.add(closed);
    out += closed.bytes;
    if (ends != nullptr) ends->push_back(out.size() - (closed.bytes.size() - closed.length));
  }
  EXPECT_EQ(file.size(), out.size());
  return whole ? out + file.end() : out;
}

struct Got {
  std::vector<McapText> messages;
  bool complete = false;
  std::string damage;
};
Got read(const std::string& bytes) {
  std::istringstream in(bytes);
  McapReader reader(in);
  Got out;
  while (const auto m = reader.next()) {
    out.messages.push_back({m->channel, m->sequence, m->log_time, std::string(m->data)});
  }
  out.complete = reader.complete();
  out.damage = reader.damage();
  EXPECT_FALSE(reader.next()) << "nothing comes after the end";
  return out;
}

void expect_first_of(const Got& got, const std::vector<McapText>& all, std::size_t count) {
  ASSERT_EQ(got.messages.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(got.messages[i].channel, all[i].channel);
    EXPECT_EQ(got.messages[i].sequence, all[i].sequence);
    EXPECT_EQ(got.messages[i].time, all[i].time);
    ASSERT_EQ(got.messages[i].data, all[i].data);
  }
}

TEST(Mcap, WhatIsWrittenComesBack) {
  const auto all = some_messages(37, 1);
  const std::string bytes = file_of(all);
  const Got got = read(bytes);
  expect_first_of(got, all, all.size());
  EXPECT_TRUE(got.complete);
  EXPECT_EQ(got.damage, "");
  std::istringstream in(bytes);
  McapReader reader(in);
  ASSERT_TRUE(reader.next());
  ASSERT_EQ(reader.layout().channels.size(), 2u);
  EXPECT_EQ(reader.layout().channels[1].topic, "/two");
  ASSERT_NE(reader.schema_of(1), nullptr);
  EXPECT_EQ(reader.schema_of(1)->name, "a.B");
  EXPECT_EQ(reader.schema_of(2), nullptr);
  EXPECT_EQ(reader.schema_of(3), nullptr);
}

TEST(Mcap, CutAtAnyByteItGivesTheWholeChunksBefore) {
  const auto all = some_messages(24, 2);
  std::vector<std::size_t> ends;
  const std::string bytes = file_of(all, &ends);
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    std::size_t whole = 0;
    while (whole < ends.size() && ends[whole] <= cut) ++whole;
    const Got got = read(bytes.substr(0, cut));
    ASSERT_EQ(got.messages.size(), std::min<std::size_t>(4 * whole, all.size()))
        << "cut at " << cut;
    expect_first_of(got, all, got.messages.size());
    // The data may be whole although the file is not.
    EXPECT_TRUE(got.complete || !got.damage.empty()) << "cut at " << cut;
  }
}

TEST(Mcap, WithAnyByteChangedNothingFalseIsRead) {
  const auto all = some_messages(12, 3);
  const std::string bytes = file_of(all);
  const std::size_t first_chunk = bytes.find("zstd");
  ASSERT_NE(first_chunk, std::string::npos);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int bit : {0, 3, 7}) {
      std::string spoilt = bytes;
      spoilt[at] = static_cast<char>(spoilt[at] ^ (1 << bit));
      const Got got = read(spoilt);
      ASSERT_LE(got.messages.size(), all.size());
      for (const McapText& m : got.messages) {
        // What stands in a chunk has a checksum. A chunk that no longer says that it is one is left
        // out.
        ASSERT_TRUE(m.sequence >= 1 && m.sequence <= all.size());
        ASSERT_EQ(m.data, all[m.sequence - 1].data) << "byte " << at << ", bit " << bit;
        ASSERT_EQ(m.time, all[m.sequence - 1].time) << "byte " << at << ", bit " << bit;
      }
    }
  }
}

TEST(Mcap, ALengthThatLiesCostsNoMemory) {
  std::string bytes(kMcapMagic);
  bytes += '\x06';
  bytes += std::string("\xff\xff\xff\x03\0\0\0\0", 8);  // 64 MiB, that are not there
  EXPECT_NE(read(bytes).damage.find("cut within a record"), std::string::npos);
  bytes[bytes.size() - 1] = '\x7f';
  EXPECT_NE(read(bytes).damage.find("expected at most"), std::string::npos);
  EXPECT_NE(read("no file").damage.find("byte 0: expected the beginning"), std::string::npos);
}

TEST(Mcap, AMessageOfAnUnknownChannelIsDamage) {
  McapFile file(McapLayout{});
  McapChunkBuilder chunk;
  chunk.add({7, 1, 0, 0, "x"});
  const std::string bytes = file.begin() + chunk.close().bytes;
  EXPECT_NE(read(bytes).damage.find("channel 7, which the file does not tell of"),
            std::string::npos);
}

}  // namespace
}  // namespace handrail
