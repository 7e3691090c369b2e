// The PNG reader on files that are wrong in any way: it says so, or reads an image that is whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "server/base/read_file.h"
#include "server/scene/text_io.h"
#include "tests/support/png_sample.h"
#include "tests/support/png_whole.h"

namespace handrail {
namespace {

// The files that were made, beside the ones that a fuzzer found.
std::vector<std::string> corpus() {
  std::vector<std::string> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(HANDRAIL_SOURCE_DIR "/tests/fuzz/corpus/png")) {
    if (entry.path().extension() == ".png") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> out;
  for (const std::string& file : files) {
    const Result<std::string> bytes = read_file(file, 1 << 20);
    EXPECT_TRUE(bytes.is_ok()) << bytes.message();
    if (bytes) out.push_back(*bytes);
  }
  return out;
}

struct Chunk {
  std::string type, contents;
};

// The chunks that are whole.
std::vector<Chunk> chunks_of(const std::string& png) {
  std::vector<Chunk> out;
  for (std::size_t at = 8; at + 12 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i)
      length = length << 8 | static_cast<std::uint8_t>(png[at + i]);
    if (length > png.size() - at - 12) break;
    out.push_back({png.substr(at + 4, 4), png.substr(at + 8, length)});
    at += length + 12;
  }
  return out;
}

// Changes a file's chunks and puts it together with right checksums, or its plain bytes.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::string mutate(const std::string& png, const std::vector<std::string>& others) {
    if (below(4) == 0) return bytes(png);
    std::vector<Chunk> chunks = chunks_of(png);
    if (chunks.empty()) return bytes(png);
    for (std::size_t n = 1 + below(3); n > 0; --n) change(chunks, others);
    std::string out = "\x89PNG\r\n\x1a\n";
    for (const Chunk& c : chunks) out += test::chunk_of(c.type, c.contents);
    return below(20) == 0 ? bytes(out) : out;
  }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

 private:
  std::string bytes(std::string out) {
    for (std::size_t n = 1 + below(4); n > 0 && !out.empty(); --n) {
      const std::size_t at = below(out.size());
      switch (below(4)) {
        case 0: out.resize(at); break;
        case 1: out.insert(at, 1 + below(8), static_cast<char>(random_())); break;
        default: out[at] = static_cast<char>(random_());
      }
    }
    return out;
  }
  void change(std::vector<Chunk>& chunks, const std::vector<std::string>& others) {
    const std::size_t i = below(chunks.size());
    Chunk& chunk = chunks[i];
    switch (below(6)) {
      case 0:
        chunks.erase(chunks.begin() + static_cast<std::ptrdiff_t>(i));
        if (chunks.empty()) chunks.push_back({"IEND", ""});
        break;
      case 1: chunks.insert(chunks.begin() + static_cast<std::ptrdiff_t>(i), Chunk(chunk)); break;
      case 2: {
        const std::vector<Chunk> from = chunks_of(others[below(others.size())]);
        if (!from.empty())
          chunks.insert(chunks.begin() + static_cast<std::ptrdiff_t>(i), from[below(from.size())]);
        break;
      }
      case 3:
        if (chunks[0].contents.size() >= 13) {
          // Size (small: time), depth, colour type, interlace.
          const std::size_t at = std::vector<std::size_t>{2, 3, 6, 7, 8, 9, 12}[below(7)];
          chunks[0].contents[at] = static_cast<char>(below(at == 2 || at == 6 ? 3
                                                           : at < 8           ? 256
                                                                              : 18));
        }
        break;
      default: chunk.contents = bytes(chunk.contents);
    }
  }

  std::mt19937 random_;
};

void expect_whole_or_refused(const std::string& bytes, std::size_t& read) {
  bool is_read = false;
  ASSERT_EQ(test::fault_with_png(bytes, is_read), "");
  read += is_read ? 1 : 0;
}

TEST(PngFuzz, TheCorpusItselfIsWholeOrRefused) {
  std::size_t read = 0;
  const std::vector<std::string> files = corpus();
  for (const std::string& file : files) expect_whole_or_refused(file, read);
  EXPECT_EQ(files.size(), 15U);
  EXPECT_EQ(read, 11U);
}

TEST(PngFuzz, WhateverIsWrongWithAFileItIsWholeOrRefused) {
  const std::vector<std::string> files = corpus();
  ASSERT_FALSE(files.empty());
  Mutator mutator(4);
  std::size_t read = 0;
  constexpr std::size_t kCases = 4000;
  for (std::size_t i = 0; i < kCases && !HasFatalFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    expect_whole_or_refused(mutator.mutate(files[mutator.below(files.size())], files), read);
  }
  // Neither all refused, which would try nothing, nor all read.
  EXPECT_GT(read, kCases / 20);
  EXPECT_LT(read, kCases * 19 / 20);
}

}  // namespace
}  // namespace handrail
