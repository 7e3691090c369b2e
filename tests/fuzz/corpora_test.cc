// The inputs that the fuzzers have kept, each through its target again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "server/base/read_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 100'000;  // of a corpus: it is in every checkout
const fs::path kCorpora = HANDRAIL_SOURCE_DIR "/tests/fuzz/corpus";

class Corpus : public ::testing::TestWithParam<Target> {};

// A target whose check fails ends the program; the file named last is the one.
TEST_P(Corpus, IsHandledInputByInput) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kCorpora / GetParam().name)) {
    files.insert(entry.path());
  }
  EXPECT_FALSE(files.empty());
  std::size_t size = 0;
  for (const fs::path& file : files) {
    const Result<std::string> input = read_file(file.string(), kMostBytes);
    ASSERT_TRUE(input.is_ok()) << input.message();
    size += input->size();
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);
    GetParam().run({reinterpret_cast<const std::uint8_t*>(input->data()), input->size()});
  }
  EXPECT_LE(size, kMostBytes);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, ::testing::ValuesIn(targets()),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Corpora, EachHasItsTarget) {
  std::set<std::string> folders, names;
  for (const auto& entry : fs::directory_iterator(kCorpora)) {
    folders.insert(entry.path().filename().string());
  }
  for (const Target& target : targets()) names.insert(target.name);
  EXPECT_EQ(folders, names);
}

}  // namespace
}  // namespace handrail::fuzz
