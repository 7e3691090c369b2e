#include "server/base/output.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::size_t files_in(const std::string& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

TEST(NewFile, WhatWasThereStaysUntilTheNewOneIsWhole) {
  const TempFolder folder;
  const std::string path = folder.write("a.txt", "old");
  {
    NewFile file(path);
    ASSERT_TRUE(file.opened()) << file.opened().message();
    EXPECT_EQ(text_of(path), "old");
  }
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1u);  // nothing half-written stays
  EXPECT_TRUE(write_file(path, "new"));
  EXPECT_EQ(text_of(path), "new");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(NewFile, KeepsTheModeAndFollowsALink) {
  const TempFolder folder;
  const std::string path = folder.write("a.txt", "old"), link = folder.path() + "/link";
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  std::filesystem::create_symlink(path, link);
  ASSERT_TRUE(write_file(link, "new"));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(text_of(path), "new");
  struct ::stat there {};
  ASSERT_EQ(::stat(path.c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 07777, 0640u);
}

TEST(NewFile, WhereItCannotBeWrittenThePathAndTheReasonAreNamed) {
  const TempFolder folder;
  const std::string nowhere = folder.path() + "/missing/a.txt";
  EXPECT_EQ(write_file(nowhere, "a").message(),
            nowhere + ": cannot write: No such file or directory");
  EXPECT_EQ(write_file(folder.path(), "a").message(),
            folder.path() + ": cannot write: Is a directory");
  EXPECT_EQ(write_file("/dev/full", "a").message(),
            "/dev/full: cannot write: No space left on device");
  EXPECT_TRUE(write_file("/dev/null", "a"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

// The file system's own limit stands for a full disk.
TEST(NewFileDeathTest, AFileThatDoesNotFitLeavesWhatWasThere) {
  const TempFolder folder;
  const std::string path = folder.write("a.txt", "old");
  const auto write_much = [&] {
    ::rlimit small{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &small);
    ::signal(SIGXFSZ, SIG_IGN);
    const Status s = write_file(path, std::string(100000, 'x'));
    std::fprintf(stderr, "%s\n", s.message().c_str());
    std::_Exit(s ? 1 : 0);
  };
  EXPECT_EXIT(write_much(), ::testing::ExitedWithCode(0), "a.txt: cannot write: File too large");
  EXPECT_EQ(text_of(path), "old");
  EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(EndOutputDeathTest, AFullDiskUnderTheStandardOutputIsNoSuccess) {
  const auto end = [](const char* path, int code) {
    if (std::freopen(path, "w", stdout) == nullptr) std::_Exit(9);
    std::printf("a result\n");
    std::_Exit(end_output("tool", code));
  };
  EXPECT_EXIT(end("/dev/full", 0), ::testing::ExitedWithCode(1),
              "tool: the standard output cannot be written: No space left on device");
  EXPECT_EXIT(end("/dev/full", 3), ::testing::ExitedWithCode(3), "cannot be written");
  EXPECT_EXIT(end("/dev/null", 0), ::testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace handrail
