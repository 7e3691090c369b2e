// A trial's way on the disk and back.
#include "client/experiment/trace_csv.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string trace_in(const TempFolder& folder) {
  std::string file = trace_file(folder.path(), "linear-movement", "anna", 3);
  std::vector<TraceRow> rows(3);
  for (int i = 0; i < 3; ++i) {
    rows[static_cast<std::size_t>(i)].time = 7.0 + 0.25 * i;
    rows[static_cast<std::size_t>(i)].X_ST.p = {0.1 * i, 0.5, -0.25};
    rows[static_cast<std::size_t>(i)].f_H_M = {0.0, 0.0, 1.5 * i};
  }
  EXPECT_TRUE(write_trace(file, rows));
  return file;
}

TEST(TraceCsv, ColumnsComeBackAsTheyAreAskedFor) {
  const TempFolder folder;
  const std::string file = trace_in(folder);
  EXPECT_EQ(file, folder.path() + "/linear-movement.anna.03.csv");
  const auto rows = read_trace(file, {"force_z_n", "tip_x_mm", "time_s"});
  ASSERT_TRUE(rows) << rows.message();
  EXPECT_THAT(*rows, ElementsAre(ElementsAre(0.0, 0.0, 0.0), ElementsAre(1.5, 100.0, 0.25),
                                 ElementsAre(3.0, 200.0, 0.5)));
}

TEST(TraceCsv, ALastLineThatIsCutIsLeftOut) {
  const TempFolder folder;
  const std::string file = trace_in(folder);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 2);
  EXPECT_EQ(read_trace(file, {"time_s"})->size(), 2u);
}

TEST(TraceCsv, WhatIsWrongIsNamedWithItsPlace) {
  const TempFolder folder;
  const std::string file = trace_in(folder);
  EXPECT_THAT(read_trace(file, {"time_s", "depth_mm"}).message(),
              HasSubstr("03.csv: line 1: no column 'depth_mm'"));
  EXPECT_THAT(read_trace(file + "x", {"time_s"}).message(), HasSubstr("cannot be read"));
  // The phase is a word.
  EXPECT_THAT(read_trace(file, {"phase"}).message(),
              HasSubstr("03.csv: line 2: phase is 'AB', expected a number"));
  std::ofstream(file) << "time_s,a\n1\n";
  EXPECT_THAT(read_trace(file, {"a"}).message(), HasSubstr("line 2: a is '', expected a number"));
}

}  // namespace
}  // namespace handrail
