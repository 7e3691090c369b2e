// Finished runs in a file.
#include "server/lab/faults/fault_journal.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <limits>
#include <sstream>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

FaultOutcome some_outcome() {
  FaultOutcome out;
  measure(out, 1.0 / 3.0, 1e-300);
  find(out, 3, "moved without being led");
  find(out, 1, "not found");
  out.settled = std::numeric_limits<double>::infinity();
  out.harder = -0.1;
  return out;
}

class FaultJournalTest : public ::testing::Test {
 protected:
  std::string text() const {
    std::ostringstream out;
    out << std::ifstream(path).rdbuf();
    return out.str();
  }
  void append_raw(const std::string& bytes) const {
    std::ofstream(path, std::ios::binary | std::ios::app) << bytes;
  }

  TempFolder folder;
  std::string path = folder.path() + "/runs.txt";
};

TEST_F(FaultJournalTest, WhatWasAppendedIsFoundAgainToTheBit) {
  {
    auto journal = FaultJournal::open(path, "A");
    ASSERT_TRUE(journal.is_ok()) << journal.message();
    EXPECT_EQ(journal->find("N13", 7, 0), nullptr);
    ASSERT_TRUE(journal->append("N13", 7, 0, some_outcome()));
    ASSERT_TRUE(journal->append("N13", 7, 1, {}));
  }
  const auto journal = FaultJournal::open(path, "A");
  ASSERT_TRUE(journal.is_ok()) << journal.message();
  const FaultOutcome* run = journal->find("N13", 7, 0);
  ASSERT_NE(run, nullptr);
  EXPECT_EQ(run->violations, 4u);
  EXPECT_TRUE(run->measured);
  EXPECT_EQ(run->worst, 1.0 / 3.0);
  EXPECT_EQ(run->bound, 1e-300);
  EXPECT_EQ(run->found, "3 x moved without being led, 1 x not found");
  EXPECT_EQ(run->settled, std::numeric_limits<double>::infinity());
  EXPECT_EQ(run->harder, -0.1);
  ASSERT_NE(journal->find("N13", 7, 1), nullptr);
  EXPECT_FALSE(journal->find("N13", 7, 1)->measured);
  EXPECT_EQ(journal->find("N13", 7, 1)->found, "");
  EXPECT_EQ(journal->find("N13", 8, 0), nullptr);
  EXPECT_EQ(journal->find("N1", 7, 0), nullptr);
}

// A kill may end a program at any byte of what it writes.
TEST_F(FaultJournalTest, AFileCutAnywhereGivesTheWholeLinesBeforeTheCut) {
  {
    auto journal = FaultJournal::open(path, "A");
    ASSERT_TRUE(journal->append("S1a", 1, 0, some_outcome()));
    ASSERT_TRUE(journal->append("S1a", 1, 1, {}));
  }
  const std::string whole = text();
  for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
    folder.write("runs.txt", whole.substr(0, cut));
    const auto lines = std::count(whole.begin(), whole.begin() + static_cast<long>(cut), '\n');
    auto journal = FaultJournal::open(path, "A");
    ASSERT_TRUE(journal.is_ok()) << cut << ": " << journal.message();
    EXPECT_EQ(journal->find("S1a", 1, 0) != nullptr, lines >= 2) << cut;
    EXPECT_EQ(journal->find("S1a", 1, 1) != nullptr, lines >= 3) << cut;
    ASSERT_TRUE(journal->append("S1a", 1, 0, some_outcome()));
    ASSERT_TRUE(journal->append("S1a", 1, 1, {}));
    EXPECT_EQ(FaultOutcome(*journal->find("S1a", 1, 0)).violations, 4u);
    EXPECT_THAT(text(), HasSubstr("\nS1a 1 0 "));
    EXPECT_EQ(text().back(), '\n');
  }
}

TEST_F(FaultJournalTest, ResultsOfAnotherJudgeAreRefusedAndLeftAlone) {
  {
    auto journal = FaultJournal::open(path, "program 1, whole");
    ASSERT_TRUE(journal->append("S1a", 1, 0, {}));
  }
  const std::string before = text();
  const auto journal = FaultJournal::open(path, "program 2, whole");
  ASSERT_FALSE(journal.is_ok());
  EXPECT_THAT(journal.message(), HasSubstr(path + ":1: "));
  EXPECT_THAT(journal.message(), HasSubstr("program 1, whole"));
  EXPECT_THAT(journal.message(), HasSubstr("program 2, whole"));
  EXPECT_EQ(text(), before);
}

TEST_F(FaultJournalTest, AFileThatIsNoJournalIsRefusedAndLeftAlone) {
  for (const char* foreign : {"hello", "hello\nworld\n", "\n", "handrail-lab was here"}) {
    folder.write("runs.txt", foreign);
    const auto journal = FaultJournal::open(path, "A");
    ASSERT_FALSE(journal.is_ok()) << foreign;
    EXPECT_THAT(journal.message(), HasSubstr(path + ":1: no results of handrail-lab faults"));
    EXPECT_EQ(text(), foreign);
  }
  const auto nowhere = FaultJournal::open("/nowhere/runs.txt", "A");
  ASSERT_FALSE(nowhere.is_ok());
  EXPECT_THAT(nowhere.message(), HasSubstr("cannot open /nowhere/runs.txt"));
}

TEST_F(FaultJournalTest, ALineThatIsNoResultIsNamed) {
  ASSERT_TRUE(FaultJournal::open(path, "A")->append("S1a", 1, 0, {}));
  for (const char* line : {"S1a 1 one 0 0 0 0 0 0 0 \n", "S1a 1 1 0 0 0 0\n", "\n"}) {
    const std::string good = text();
    append_raw(line);
    const auto journal = FaultJournal::open(path, "A");
    ASSERT_FALSE(journal.is_ok()) << line;
    EXPECT_THAT(journal.message(), HasSubstr(path + ":3: no result of a run"));
    folder.write("runs.txt", good);
  }
}

TEST_F(FaultJournalTest, TwoProgramsDoNotWriteOneFile) {
  const auto first = FaultJournal::open(path, "A");
  ASSERT_TRUE(first.is_ok());
  const auto second = FaultJournal::open(path, "A");
  ASSERT_FALSE(second.is_ok());
  EXPECT_THAT(second.message(), HasSubstr("another run writes its results here"));
}

// A file that may not grow, as on a full disk.
TEST_F(FaultJournalTest, WhatCannotBeWrittenWholeIsAnErrorAndNoResult) {
  {
    auto journal = FaultJournal::open(path, "A");
    ASSERT_TRUE(journal->append("S1a", 1, 0, {}));
    struct rlimit before {};
    ::getrlimit(RLIMIT_FSIZE, &before);
    struct rlimit small = before;
    small.rlim_cur = text().size() + 5;
    const auto last = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &small);
    const Status written = journal->append("S1a", 1, 1, {});
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, last);
    ASSERT_FALSE(written.is_ok());
    EXPECT_THAT(written.message(), HasSubstr("cannot write " + path));
  }
  const auto journal = FaultJournal::open(path, "A");
  ASSERT_TRUE(journal.is_ok()) << journal.message();
  EXPECT_NE(journal->find("S1a", 1, 0), nullptr);
  EXPECT_EQ(journal->find("S1a", 1, 1), nullptr);
}

TEST_F(FaultJournalTest, WhatIsNoFileIsRefused) {
  for (const char* device : {"/dev/zero", "/dev/null"}) {
    const auto journal = FaultJournal::open(device, "A");
    ASSERT_FALSE(journal.is_ok()) << device;
    EXPECT_THAT(journal.message(), HasSubstr(std::string(device) + ": not a file"));
  }
}

}  // namespace
}  // namespace handrail
